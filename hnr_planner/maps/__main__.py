"""
Draw the sample maps of ``config/maps``.

``python -m hnr_planner.maps`` in the project's folder writes ``config/maps/office.yaml`` and
``office.png``, the same in every run; the only argument may name another folder.
"""

from pathlib import Path
import sys

from hnr_planner.maps.building import building
from hnr_planner.maps.map_server import save_map

#: Seed of the office map.
OFFICE_SEED = 5


def main(folder: Path) -> None:
    """Write the sample map into a folder, which is created where it is missing."""
    folder.mkdir(parents=True, exist_ok=True)
    save_map(building(OFFICE_SEED), folder / 'office.yaml')


if __name__ == '__main__':
    main(Path(sys.argv[1] if len(sys.argv) > 1 else 'config/maps'))
