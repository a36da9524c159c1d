"""
Bring the pages of the experiments up to date with their numbers.

``python -m hnr_planner.experiments`` in the project's folder gives the tables of ``docs/NAME.md``
the rows of ``docs/figures/NAME.md``.
"""

from pathlib import Path

from hnr_planner.experiments import NAMES
from hnr_planner.experiments.pages import refresh


def main(docs: Path) -> None:
    """Refresh every page."""
    for name in NAMES:
        refresh(docs, name)


if __name__ == '__main__':
    main(Path('docs'))
