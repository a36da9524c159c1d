"""
Update the tables of the experiments' pages.

``python -m hnr_planner.experiments``, run in the project's folder, replaces the rows of the tables
in ``docs/NAME.md`` by those of ``docs/figures/NAME.md``.
"""

from pathlib import Path

from hnr_planner.experiments.pages import refresh
from hnr_planner.experiments.registry import NAMES


def main(docs: Path) -> None:
    """Update the page of every experiment in the folder ``docs``."""
    for name in NAMES:
        refresh(docs, name)


if __name__ == '__main__':
    main(Path('docs'))
