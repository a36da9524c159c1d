"""Maps to run commands on, and two ways to run them."""

from collections.abc import Callable
import os
from pathlib import Path
import subprocess
import sys
from typing import NamedTuple

from hnr_planner.cli.main import main
from hnr_planner.core import warm_up
from hnr_planner.maps import OccupancyMap, save_map
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
OFFICE = ROOT / 'config' / 'maps' / 'office.yaml'
MAPS = Path(os.environ.get('HNR_MAPS', '/nonexistent'))
REAL_MAPS = sorted(file for file in MAPS.glob('*') if file.suffix in ('.yaml', '.map'))
TIME_LIMIT = 120.0


class Ran(NamedTuple):
    """Exit code and output of a command."""

    code: int
    out: str
    err: str


def run_process(*arguments: object, cwd: Path | None = None, **environment: str) -> Ran:
    """Run ``python -m hnr_planner`` as a user does, in a process of its own."""
    done = subprocess.run(
        [sys.executable, '-m', 'hnr_planner', *map(str, arguments)],
        cwd=cwd or ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=TIME_LIMIT,
        check=False,
    )
    return Ran(done.returncode, done.stdout, done.stderr)


@pytest.fixture(scope='session')
def compiled() -> None:
    """Load the machine code once, so that no command waits for it."""
    warm_up('paths', 'samples')


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Callable[..., Ran]:
    """Return a function that runs a command in this process."""

    def run_here(*arguments: object) -> Ran:
        code = main([str(argument) for argument in arguments])
        return Ran(code, *capsys.readouterr())

    return run_here


@pytest.fixture(scope='session')
def rooms() -> OccupancyMap:
    """Return two rooms, 8 m x 4 m, with a door, and a closed cupboard in a corner; turned."""
    data = np.zeros((40, 80), dtype=np.int8)
    data[[0, -1]] = data[:, [0, -1]] = 100
    data[:, 39:41] = 100
    data[15:25, 39:41] = 0
    data[30, 70:] = data[30:, 70] = 100
    return OccupancyMap(data, 0.1, (-3.0, 2.0, 0.4))


@pytest.fixture(scope='session')
def rooms_file(rooms: OccupancyMap, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the map file of the two rooms."""
    file = tmp_path_factory.mktemp('maps') / 'rooms.yaml'
    save_map(rooms, file)
    return file


@pytest.fixture(scope='session')
def solid_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a map file without a free cell."""
    file = tmp_path_factory.mktemp('maps') / 'solid.yaml'
    save_map(OccupancyMap(np.full((5, 6), 100, dtype=np.int8), 0.1), file)
    return file


def at(occupancy: OccupancyMap, row: float, col: float) -> tuple[float, float]:
    """Return the centre (x, y) [m] of a cell, in the map frame."""
    x, y, yaw = occupancy.origin
    right, up = (col + 0.5) * occupancy.resolution, (row + 0.5) * occupancy.resolution
    return (
        float(x + right * np.cos(yaw) - up * np.sin(yaw)),
        float(y + right * np.sin(yaw) + up * np.cos(yaw)),
    )
