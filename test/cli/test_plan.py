"""The command ``plan``."""

from collections.abc import Callable
import json
import math
from pathlib import Path
from test.brute_force import path_collisions
from test.cli.conftest import at, OFFICE, Ran, run_process
from test.cli.pictures import check_picture
from test.fresh_python import run_and_list_imports

from hnr_planner.cli.main import build_parser
from hnr_planner.cli.plan import OPTIMIZE_FOR, optimize_for
from hnr_planner.cli.sample import WALK_NAMES
from hnr_planner.core import ALGORITHMS, GridSpace, WALKS
from hnr_planner.core.planning.registry import PLANNERS
from hnr_planner.maps import load_map, OccupancyMap, save_map, spiral
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures('compiled')

Run = Callable[..., Ran]
KEYS = [
    'status',
    'message',
    'algorithm',
    'seed',
    'iterations',
    'elapsed',
    'length',
    'lower_bound',
    'clear_lower_bound',
    'next_lower_bound',
    'path',
    'paths',
    'goal_offset',
    'escape',
]

#: What may have made a path of auto.
OF_AUTO = {'hit_and_run_connect', 'polyanya', 'flood_fill'}


def ends(rooms: OccupancyMap) -> list[object]:
    """Return arguments for a start in one room and a goal in the other."""
    return ['--start', *at(rooms, 5, 5), '--goal', *at(rooms, 8, 75)]


def test_help_names_what_the_core_has(run: Run) -> None:
    assert set(WALK_NAMES) == set(WALKS)
    text = run('plan', '--help').out
    for entry in PLANNERS:
        assert f'  {entry.name} ' in text and entry.summary in text


@pytest.mark.parametrize(
    'command', [[], ['plan'], ['tour'], ['sample'], ['demo'], ['experiment'], ['compile']]
)
def test_help_imports_nothing_heavy(command: list[str]) -> None:
    program = f'from hnr_planner.cli.main import main\nassert main({[*command, "--help"]}) == 0'
    printed, packages = run_and_list_imports(program)
    assert packages.isdisjoint({'numpy', 'numba', 'matplotlib', 'rclpy'})
    assert 'example' in printed


@pytest.mark.parametrize('algorithm', ALGORITHMS)
@pytest.mark.parametrize('radius', [0.0, 0.25])
def test_json_holds_a_free_path(
    run: Run, rooms: OccupancyMap, rooms_file: Path, algorithm: str, radius: float
) -> None:
    ran = run(
        'plan', rooms_file, *ends(rooms), '--algorithm', algorithm, '--json', '--seed', 3,
        '--robot-radius', radius, '--time-limit', 600,
    )  # fmt: skip
    assert (ran.code, ran.err) == (0, '')
    result = json.loads(ran.out)
    assert list(result) == KEYS
    assert (result['status'], result['seed']) == ('SOLVED', 3)
    assert result['algorithm'] in (OF_AUTO if algorithm == 'auto' else {algorithm})
    assert algorithm in ('auto', result['algorithm'])
    path = np.array(result['path'])
    assert path[0].tolist() == list(at(rooms, 5, 5))
    assert path[-1].tolist() == list(at(rooms, 8, 75))
    occupied = rooms.data >= 65
    collisions = path_collisions(
        path, occupied, rooms.resolution, rooms.origin, robot_radius=radius
    )
    assert collisions == []
    assert result['length'] == pytest.approx(sum(map(math.dist, path[:-1], path[1:])))


def test_same_seed_same_path_in_another_process(run: Run) -> None:
    def result(run: Run) -> dict:
        ran = run(
            'plan', OFFICE, '--start', 3, 22, '--goal', 34, 5, '--robot-radius', 0.22,
            '--algorithm', 'hit_and_run', '--seed', 7, '--time-limit', 600, '--json',
            '--optimize-for', 0,
        )  # fmt: skip
        assert ran.code == 0, ran.err
        return {key: value for key, value in json.loads(ran.out).items() if key != 'elapsed'}

    first = result(run)
    assert first['iterations'] > 10
    assert first == result(run_process)
    office = load_map(OFFICE)
    blocked = (office.data < 0) | (office.data >= 65)
    assert path_collisions(first['path'], blocked, office.resolution, office.origin) == []


def test_summary_says_what_a_person_wants_to_know(
    run: Run, rooms: OccupancyMap, rooms_file: Path
) -> None:
    command = ['plan', rooms_file, *ends(rooms), '--seed', 5]
    summary, result = run(*command), json.loads(run(*command, '--json').out)
    assert summary.code == 0
    for words in ('SOLVED', 'seed 5', f'{result["length"]:.2f} m', result['algorithm']):
        assert words in summary.out
    assert len(summary.out.splitlines()) <= 5


@pytest.mark.parametrize(
    ('start', 'goal', 'status'),
    [
        ((5, 5), (35, 75), 'UNREACHABLE'),
        ((-20, 5), (8, 75), 'INVALID_START'),
        ((0, 5), (8, 75), 'INVALID_START'),
        ((5, 5), (5, 40), 'INVALID_GOAL'),
    ],
)
def test_without_a_path_the_code_is_1_and_the_message_says_why(
    run: Run,
    rooms: OccupancyMap,
    rooms_file: Path,
    start: tuple[int, int],
    goal: tuple[int, int],
    status: str,
) -> None:
    command = ['plan', rooms_file, '--start', *at(rooms, *start), '--goal', *at(rooms, *goal)]
    ran = run(*command, '--json')
    result = json.loads(ran.out)
    assert (ran.code, ran.err, result['status']) == (1, '', status)
    assert (result['path'], result['length']) == ([], None)
    named = at(rooms, *(start if status == 'INVALID_START' else goal))
    assert f'{named[0]:g}' in result['message']
    summary = run(*command)
    assert summary.code == 1
    assert summary.out.startswith(f'{status}: {result["message"]}')


def test_a_robot_beyond_all_measure_stands_nowhere(
    run: Run, rooms: OccupancyMap, rooms_file: Path
) -> None:
    ran = run('plan', rooms_file, *ends(rooms), '--robot-radius', '1e308', '--json')
    assert (ran.code, json.loads(ran.out)['status']) == (1, 'INVALID_START')


def test_limit_of_time_is_a_status(run: Run, rooms: OccupancyMap, rooms_file: Path) -> None:
    ran = run('plan', rooms_file, *ends(rooms), '--time-limit', '1e-9', '--json')
    assert (ran.code, json.loads(ran.out)['status']) == (1, 'TIMEOUT')


def test_start_equal_to_goal_is_solved(run: Run, rooms: OccupancyMap, rooms_file: Path) -> None:
    here = at(rooms, 5, 5)
    ran = run('plan', rooms_file, '--start', *here, '--goal', *here, '--json')
    result = json.loads(ran.out)
    assert (ran.code, result['length']) == (0, 0.0)
    assert result['path'] == [list(here), list(here)]


def test_goal_radius_ends_near_the_goal(run: Run, rooms: OccupancyMap, rooms_file: Path) -> None:
    command = ['plan', rooms_file, *ends(rooms), '--goal-radius', 0.5, '--seed', 1, '--json']
    command += ['--algorithm', 'rrt']
    end = json.loads(run(*command, '--time-limit', 600).out)['path'][-1]
    assert 0.0 < math.dist(end, at(rooms, 8, 75)) <= 0.5


def test_no_simplify_leaves_the_detours(run: Run, rooms: OccupancyMap, rooms_file: Path) -> None:
    command = ['plan', rooms_file, *ends(rooms), '--algorithm', 'hit_and_run', '--seed', 1]
    command += ['--json', '--time-limit', 600]
    simple, raw = (
        json.loads(run(*command, *more).out) for more in (['--optimize-for', 0], ['--no-simplify'])
    )
    assert raw['iterations'] == simple['iterations']
    assert len(raw['path']) == raw['iterations'] + 2
    assert raw['length'] > simple['length']


def test_optimize_for_never_ends_with_a_longer_path(
    run: Run, rooms: OccupancyMap, rooms_file: Path
) -> None:
    command = ['plan', rooms_file, *ends(rooms), '--algorithm', 'rrt', '--seed', 1, '--json']
    command += ['--time-limit', 600]
    plain, better = (json.loads(run(*command, '--optimize-for', time).out) for time in (0, 0.3))
    assert better['length'] <= plain['length']
    assert better['iterations'] > plain['iterations']


def test_the_path_is_optimized_by_default_unless_it_is_not_to_be_simplified() -> None:
    parser = build_parser()
    command = ['plan', 'map.yaml', '--start', '1', '1', '--goal', '2', '2']
    assert optimize_for(parser.parse_args(command)) == OPTIMIZE_FOR == 0.02
    assert optimize_for(parser.parse_args([*command, '--optimize-for', '0'])) == 0.0
    assert optimize_for(parser.parse_args([*command, '--no-simplify'])) == 0.0
    assert optimize_for(parser.parse_args([*command, '--no-simplify', '--optimize-for', '1'])) == 1


def test_time_limit_ends_a_search_that_would_go_on(run: Run, tmp_path: Path) -> None:
    corridor, file = spiral(0.12), tmp_path / 'spiral.yaml'
    save_map(corridor.occupancy, file)
    command = ['plan', file, '--start', *corridor.start, '--goal', *corridor.goal]
    command += ['--algorithm', 'rrt', '--time-limit', 0.3, '--optimize-for', 60, '--json']
    ran = run(*command)
    result = json.loads(ran.out)
    assert (ran.code, result['status']) == (1, 'TIMEOUT')
    assert 0.3 <= result['elapsed'] < 30


def test_alternatives_are_further_paths_the_shortest_first(
    run: Run, rooms: OccupancyMap, rooms_file: Path, tmp_path: Path
) -> None:
    command = ['plan', OFFICE, '--start', 3, 22, '--goal', 34, 5, '--seed', 1]
    command += ['--alternatives', 3, '--time-limit', 600]
    result = json.loads(run(*command, '--json').out)
    assert result['paths'][0] == result['path']
    lengths = [sum(map(math.dist, path[:-1], path[1:])) for path in result['paths']]
    assert len(lengths) == 3 and lengths == sorted(lengths)
    summary = run(*command, '--plot', tmp_path / 'plan.png')
    assert all(f'{length:.2f} m' in summary.out for length in lengths)
    check_picture(tmp_path / 'plan.png')
    one = json.loads(run('plan', rooms_file, *ends(rooms), '--json').out)
    assert one['paths'] == [one['path']]


def test_clearance_keeps_the_path_away_from_walls(
    run: Run, rooms: OccupancyMap, rooms_file: Path
) -> None:
    command = ['plan', rooms_file, *ends(rooms), '--seed', 1, '--json']
    shortest, wider = (json.loads(run(*command, *more).out) for more in ([], ['--clearance', 0.2]))
    space = GridSpace.from_occupancy(rooms.data, rooms.resolution, rooms.origin)
    nearest, less_near = (space.path_clearance(each['path']) for each in (shortest, wider))
    assert nearest < 0.05 < 0.1 < less_near
    refused = run(*command, '--no-simplify', '--clearance', 0.2)
    assert refused.code == 2
    assert 'clearance must be 0 when simplify is false' in refused.err


def test_goal_tolerance_ends_beside_a_blocked_goal(
    run: Run, rooms: OccupancyMap, rooms_file: Path
) -> None:
    command = ['plan', rooms_file, '--start', *at(rooms, 5, 5), '--goal', *at(rooms, 5, 40)]
    command += ['--seed', 1, '--time-limit', 600, '--json']
    assert json.loads(run(*command).out)['status'] == 'INVALID_GOAL'
    ran = run(*command, '--goal-tolerance', 0.5)
    result = json.loads(ran.out)
    assert (ran.code, result['status']) == (0, 'SOLVED')
    offset = math.dist(result['path'][-1], at(rooms, 5, 40))
    assert 0.0 < offset <= 0.5
    assert result['goal_offset'] == pytest.approx(offset)


def test_start_escape_leads_out_of_the_inflation(
    run: Run, rooms: OccupancyMap, rooms_file: Path
) -> None:
    command = ['plan', rooms_file, '--start', *at(rooms, 5, 2), '--goal', *at(rooms, 8, 75)]
    command += ['--robot-radius', 0.25, '--seed', 1, '--time-limit', 600, '--json']
    assert json.loads(run(*command).out)['status'] == 'INVALID_START'
    ran = run(*command, '--start-escape', 1.0)
    result = json.loads(ran.out)
    assert (ran.code, result['status']) == (0, 'SOLVED')
    assert result['path'][0] == list(at(rooms, 5, 2))
    assert result['escape'] == pytest.approx(math.dist(*result['path'][:2]))
    assert 0.0 < result['escape'] <= 1.0


def test_unknown_cells_block_unless_told_otherwise(run: Run, tmp_path: Path) -> None:
    data = np.zeros((20, 20), dtype=np.int8)
    data[:, 10] = -1
    save_map(OccupancyMap(data, 0.1), tmp_path / 'map.yaml')
    command = ['plan', tmp_path / 'map.yaml', '--start', 0.5, 0.5, '--goal', 1.5, 1.5, '--json']
    assert json.loads(run(*command).out)['status'] == 'UNREACHABLE'
    assert json.loads(run(*command, '--unknown', 'free').out)['status'] == 'SOLVED'


def test_the_map_may_come_last(run: Run, rooms: OccupancyMap, rooms_file: Path) -> None:
    ran = run('plan', *ends(rooms), rooms_file)
    assert ran.code == 0, ran.err


def test_negative_and_tiny_coordinates_are_numbers(run: Run, tmp_path: Path) -> None:
    save_map(OccupancyMap(np.zeros((9, 9), np.int8), 0.1, (-0.5, -0.5, 0.0)), tmp_path / 'm.yaml')
    ran = run('plan', tmp_path / 'm.yaml', '--start', '-1e-05', '-.2', '--goal', -0.25, '1e-3')
    assert ran.code == 0, ran.err


def test_moving_ai_map(run: Run, tmp_path: Path) -> None:
    file = tmp_path / 'small.map'
    file.write_text('type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n')
    ran = run('plan', file, '--start', 0.5, 0.5, '--goal', 3.5, 2.5, '--json')
    assert (ran.code, json.loads(ran.out)['status']) == (0, 'SOLVED')


@pytest.mark.parametrize('goal', [(8, 75), (35, 75)], ids=['with path', 'without path'])
def test_plot_is_a_picture(
    run: Run, rooms: OccupancyMap, rooms_file: Path, tmp_path: Path, goal: tuple[int, int]
) -> None:
    file = tmp_path / 'plan.png'
    command = ['plan', rooms_file, '--start', *at(rooms, 5, 5), '--goal', *at(rooms, *goal)]
    ran = run(*command, '--plot', file)
    assert str(file) in ran.out
    check_picture(file)
