"""The command ``plan`` for a robot with a footprint."""

from collections.abc import Callable
import json
from pathlib import Path
from test.cli.conftest import at, Ran
from test.cli.pictures import check_picture
from test.cli.test_plan import KEYS
from test.pose_checker import PoseChecker

from hnr_planner import drawing
from hnr_planner.cli.footprint import DRIVE_NAMES
from hnr_planner.core.spaces.poses.drive import DRIVES
from hnr_planner.maps import OccupancyMap
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

Run = Callable[..., Ran]
VERTICES = [(0.3, 0.2), (0.3, -0.2), (-0.2, -0.2), (-0.2, 0.2)]
FOOTPRINT = ('--footprint', str([list(vertex) for vertex in VERTICES]))
#: No clock decides anything.
PATIENT = ('--seed', 1, '--optimize-for', 0, '--time-limit', 600)


def ends(rooms: OccupancyMap) -> list[object]:
    """Return arguments for a pose in one room and a pose in the other."""
    return ['--start', *at(rooms, 8, 8), 0.4, '--goal', *at(rooms, 10, 70), -1.0]


def test_json_holds_poses_and_the_twists_between_them(
    run: Run, rooms: OccupancyMap, rooms_file: Path
) -> None:
    options = ('--drive', 'car', '--min-turning-radius', 0.4, '--reverse-penalty', 3)
    ran = run('plan', rooms_file, *ends(rooms), *FOOTPRINT, *options, *PATIENT, '--json')
    assert ran.code == 0, ran.err
    result = json.loads(ran.out)
    after_path = KEYS.index('path') + 1
    assert list(result) == [*KEYS[:after_path], 'twists', *KEYS[after_path:]]
    path, twists = np.array(result['path']), np.array(result['twists'])
    assert PoseChecker(rooms.data > 0, 0.1, rooms.origin, VERTICES).collisions(path, twists) == []
    np.testing.assert_array_equal(path[0], [*at(rooms, 8, 8), 0.4])
    np.testing.assert_array_equal(path[-1], [*at(rooms, 10, 70), -1.0])
    assert (np.abs(twists[:, 0]) >= 0.4 * np.abs(twists[:, 2]) - 1e-9).all()
    assert not twists[:, 1].any()


def test_summary_and_picture_show_the_footprint(
    run: Run, rooms: OccupancyMap, rooms_file: Path, tmp_path: Path
) -> None:
    file = tmp_path / 'plan.png'
    options = ('--no-reverse', '--heading-tolerance', 0.1, '--plot', file)
    ran = run('plan', rooms_file, *ends(rooms), *FOOTPRINT, *options, *PATIENT)
    assert ran.code == 0, ran.err
    x, y = at(rooms, 8, 8)
    assert f'({x:.2f}, {y:.2f}, 0.40)' in ran.out and ' poses, ' in ran.out
    tint = 1.0 - 0.16 * (1.0 - np.array(to_rgb(drawing.PATH)))
    check_picture(file, drawing.PATH, '#' + ''.join(f'{round(255 * part):02x}' for part in tint))


def test_poses_that_are_drawn_are_free(
    run: Run, rooms: OccupancyMap, rooms_file: Path, tmp_path: Path
) -> None:
    start, file = (*at(rooms, 8, 8), 0.4), tmp_path / 'poses.png'
    options = ('--n', 200, '--chains', 2, '--seed', 1, *FOOTPRINT)
    ran = run('sample', rooms_file, '--start', *start, *options)
    assert ran.code == 0, ran.err
    lines = ran.out.splitlines()
    assert lines[0] == 'x,y,yaw,chain' and len(lines) == 401
    poses = np.array([line.split(',')[:3] for line in lines[1:]], dtype=float)
    assert PoseChecker(rooms.data > 0, 0.1, rooms.origin, VERTICES).is_free(poses).all()
    assert np.ptp(poses, axis=0).min() > 2.0
    assert run('sample', rooms_file, '--start', *start, *options, '--plot', file).code == 0
    check_picture(file)
    ran = run('sample', rooms_file, *options)
    assert ran.code == 2 and '--footprint needs --start X Y YAW' in ran.err


def test_sweep_is_drawn_where_the_footprint_is(rooms: OccupancyMap) -> None:
    figure = Figure(figsize=(8, 4))
    axes = figure.subplots()
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    axes.set(xlim=(-1.0, 4.0), ylim=(-1.0, 2.0))
    drawing.draw_footprints(axes, [square + (x, 0.0) for x in np.linspace(0.0, 2.0, 9)])
    swept, outlines = axes.collections
    extent = swept.get_datalim(axes.transData)
    assert extent.bounds == (0.0, 0.0, 3.0, 1.0)
    assert len(outlines.get_paths()) == 9 and swept.zorder < outlines.zorder


def test_drives_are_those_of_the_core() -> None:
    assert set(DRIVE_NAMES) == set(DRIVES)


@pytest.mark.parametrize(
    ('start', 'options', 'words'),
    [
        ([0, 0], FOOTPRINT, ['--start', 'takes three numbers, X, Y and YAW', 'not 0 0']),
        ([0, 0, 0], (), ['--start', 'takes two numbers, X and Y', 'not 0 0 0']),
        ([0, 0], ('--drive', 'car'), ['--drive needs --footprint']),
        ([0, 0], ('--no-reverse',), ['--no-reverse needs --footprint']),
        ([0, 0, 0], (*FOOTPRINT, '--robot-radius', 1), ['--robot-radius has no meaning']),
        ([0, 0, 0], (*FOOTPRINT, '--drive', 'car'), ['min_turning_radius', 'above 0 for a car']),
        ([0, 0, 0], (*FOOTPRINT, '--alternatives', 2), ['alternatives must be 1']),
        ([0, 0, 0], (*FOOTPRINT, '--algorithm', 'polyanya'), ['algorithm must be one of auto']),
        ([0, 0, 0], ('--footprint', '[]'), ['--footprint has no points']),
        ([0, 0, 0], ('--footprint', '[[0, 0], [1]]'), ['footprint must be [] or the points']),
    ],
)
def test_bad_input_is_one_line_and_code_2(
    run: Run, rooms_file: Path, start: list[object], options: tuple[object, ...], words: list[str]
) -> None:
    ran = run('plan', rooms_file, '--start', *start, '--goal', *start, *options)
    assert ran.code == 2
    assert ran.err.startswith('error: ') and ran.err.count('\n') == 1
    for word in words:
        assert word in ran.err
