"""Real surveys and a benchmark's map, from the folder that the variable HNR_MAPS names."""

import os
from pathlib import Path

from hnr_planner.maps import load_map
import numpy as np
import pytest

if 'HNR_MAPS' not in os.environ:
    pytest.skip('HNR_MAPS names no folder with real maps', allow_module_level=True)

FOLDER = Path(os.environ['HNR_MAPS'])
FILES = sorted(path for path in FOLDER.iterdir() if path.suffix in ('.yaml', '.map'))


def test_folder_has_maps() -> None:
    assert FILES


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.name)
def test_map_is_read(path: Path) -> None:
    loaded = load_map(path)
    assert loaded.data.dtype == np.int8
    assert min(loaded.data.shape) > 100
    assert {0, 100} <= set(np.unique(loaded.data)) <= {-1, 0, 100}


@pytest.mark.parametrize(
    ('name', 'unknown', 'free', 'occupied', 'place'),
    [
        ('depot.yaml', 0, 179481, 5947, (0.0, 0.0)),  # its free_thresh lets the unknown be free
        ('tb3_sandbox.yaml', 138683, 7903, 870, (-10.0, -10.0)),
        ('Denver_1_256.map', 0, 48145, 17391, (0.0, 0.0)),
    ],
)
def test_cells_of_a_known_map(
    name: str, unknown: int, free: int, occupied: int, place: tuple[float, float]
) -> None:
    if not (FOLDER / name).exists():
        pytest.skip(f'{name} is not among the maps')
    loaded = load_map(FOLDER / name)
    counts = [int((loaded.data == value).sum()) for value in (-1, 0, 100)]
    assert counts == [unknown, free, occupied]
    assert loaded.origin[:2] == place
