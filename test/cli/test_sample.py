"""The command ``sample``."""

from collections.abc import Callable
import csv
from pathlib import Path
import re
import subprocess
import sys
from test.brute_force import path_collisions
from test.cli.conftest import at, Ran, ROOT, run_process
from test.cli.pictures import check_picture

from hnr_planner.core import WALKS
from hnr_planner.maps import OccupancyMap
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures('compiled')
Run = Callable[..., Ran]


def read(text: str) -> np.ndarray:
    """Return the points (k, 2) of a CSV text whose first line is x,y."""
    header, *rows = csv.reader(text.splitlines())
    assert header == ['x', 'y']
    return np.array(rows, dtype=float)


@pytest.mark.parametrize('walk', WALKS)
def test_every_row_is_a_free_point(
    run: Run, rooms: OccupancyMap, rooms_file: Path, tmp_path: Path, walk: str
) -> None:
    file = tmp_path / 'points.csv'
    ran = run(
        'sample', rooms_file, '--n', 500, '--walk', walk, '--seed', 4, '--csv', file,
        '--robot-radius', 0.2, '--thin', 20,
    )  # fmt: skip
    assert (ran.code, ran.err) == (0, '')
    assert str(file) in ran.out and 'seed 4' in ran.out
    points = read(file.read_text())
    assert points.shape == (500, 2)
    # In twenty steps every walk moves, also the one that may refuse a step.
    assert len(np.unique(points, axis=0)) > 490
    for point in points:
        assert not path_collisions(
            [point], rooms.data >= 65, rooms.resolution, rooms.origin, robot_radius=0.2
        )


def test_points_lie_in_every_part(run: Run, rooms: OccupancyMap, rooms_file: Path) -> None:
    x, y, yaw = rooms.origin
    points = read(run('sample', rooms_file, '--n', 2000, '--seed', 1).out) - (x, y)
    cols = (points[:, 0] * np.cos(yaw) + points[:, 1] * np.sin(yaw)) / rooms.resolution
    rows = (points[:, 1] * np.cos(yaw) - points[:, 0] * np.sin(yaw)) / rooms.resolution
    assert (cols < 39).any() and (cols > 41).any()  # both rooms
    # The closed cupboard has 64 of 2891 free cells: 44 points are expected, and 7 their deviation.
    assert 10 <= ((cols > 70) & (rows > 30)).sum() <= 80


def test_chains_are_told_apart_and_each_is_the_one_of_fewer(run: Run, rooms_file: Path) -> None:
    for start in ([], ['--start', -2.0, 3.0]):
        command = ['sample', rooms_file, '--n', 40, '--seed', 2, *start]
        header, *rows = csv.reader(run(*command, '--chains', 3).out.splitlines())
        assert header == ['x', 'y', 'chain']
        assert [row[2] for row in rows] == ['0'] * 40 + ['1'] * 40 + ['2'] * 40
        points = np.array([row[:2] for row in rows], dtype=float)
        np.testing.assert_array_equal(points[:40], read(run(*command).out))
        assert len(np.unique(points, axis=0)) == 120


def test_diagnosis_is_a_line_beside_the_points(run: Run, rooms_file: Path) -> None:
    command = ['sample', rooms_file, '--n', 1000, '--seed', 5, '--diagnose']
    ran = run(*command, '--chains', 4, '--thin', 20)
    assert ran.code == 0 and len(ran.out.splitlines()) == 4001
    assert re.fullmatch(
        r'converged: R-hat at most 1\.00\d\d, \d+ effective draws or more\n', ran.err
    )
    ran = run(*command)
    assert ran.code == 0 and len(ran.out.splitlines()) == 1001
    assert ran.err.startswith('not converged: one chain cannot show') and ran.err.count('\n') == 1


def test_start_chooses_the_part(run: Run, rooms: OccupancyMap, rooms_file: Path) -> None:
    command = ['sample', rooms_file, '--n', 50, '--start', *at(rooms, 35, 75)]
    corner = np.array(at(rooms, 35, 75))
    assert (np.abs(read(run(*command).out) - corner) < 1.0).all()


def test_thin_keeps_every_third_point_of_the_walk(run: Run, rooms_file: Path) -> None:
    command = ['sample', rooms_file, '--seed', 3, '--start', -2.0, 3.0]
    every = read(run(*command, '--n', 60).out)
    np.testing.assert_array_equal(read(run(*command, '--n', 20, '--thin', 3).out), every[2::3])


def test_same_seed_same_points(rooms_file: Path, run: Run) -> None:
    command = ['sample', rooms_file, '--n', 100, '--seed', 9]
    here, there = run(*command), run_process(*command)
    assert here.code == there.code == 0
    assert here.out == there.out
    assert here.out != run('sample', rooms_file, '--n', 100, '--seed', 10).out


def test_without_a_seed_the_points_differ_but_can_be_had_again(
    run: Run, rooms_file: Path, tmp_path: Path
) -> None:
    file = tmp_path / 'points.csv'
    command = ['sample', rooms_file, '--n', 20, '--csv', file]
    printed, first = run(*command).out, file.read_text()
    run(*command)
    assert file.read_text() != first
    seed = printed.split('seed ')[1].split(')')[0]
    run(*command, '--seed', seed)
    assert file.read_text() == first


def test_plot_is_a_picture(run: Run, rooms_file: Path, tmp_path: Path) -> None:
    file = tmp_path / 'points.png'
    ran = run('sample', rooms_file, '--n', 3000, '--plot', file)
    assert ran.code == 0 and str(file) in ran.out
    check_picture(file)


def test_a_reader_that_leaves_is_no_error(rooms_file: Path) -> None:
    program = f'{sys.executable} -m hnr_planner sample {rooms_file} --n 200000 | head -n 2'
    done = subprocess.run(
        ['bash', '-o', 'pipefail', '-c', program],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert (done.returncode, done.stderr) == (0, '')
    assert len(done.stdout.splitlines()) == 2
