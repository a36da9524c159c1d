"""Goals of Nav2 as requests and outcomes as its error codes, without Nav2."""

from dataclasses import replace
from pathlib import Path
from test.brute_force import path_collisions
from test.ros.harness import pose
from test.server.test_requests import GOAL, RESOLUTION, rooms, SETTINGS, store
import threading
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

from hnr_planner.core import ALGORITHMS
from hnr_planner.ros.interfaces.nav2_goals import error_of, from_robot_on, request_of
from hnr_planner.server.outcomes import Outcome
from hnr_planner.server.path_validity import blocked_poses
from hnr_planner.server.requests import Pose
from hnr_planner.server.respond import respond
from hnr_planner.server.responses import PlanResponse
from hnr_planner.server.settings import RULES, Settings
import numpy as np
import pytest
import yaml

CONFIG = Path(__file__).parents[2] / 'config'
START = (0.5, 0.5)
INSIDE_WALL, OUTSIDE = (2.0, 0.25), (9.0, 0.5)
NAN = float('nan')


def goal_message(start: tuple[float, float] | None = START, planner_id: str = '') -> Any:
    """Return what both actions ask for besides the poses; without a start, the robot's."""
    return SimpleNamespace(
        start=pose(*(start or (7.0, 7.0))), use_start=start is not None, planner_id=planner_id
    )


def ask(*points: tuple[float, float], message: Any = None, **settings: Any) -> PlanResponse:
    """Ask for a path through points and return how that ended."""
    own = replace(SETTINGS, **settings)
    request = request_of(message or goal_message(), [pose(*point) for point in points], own)
    return respond(request, own, store(rooms()).newest, threading.Event())


def test_path_meets_all_poses_in_their_order() -> None:
    points = [(1.5, 1.6), (3.6, 1.7), GOAL, START]
    report = ask(*points)
    assert report.solved and report.result is not None, report.why
    path = report.path.tolist()
    assert path_collisions(report.path, rooms() == 100, RESOLUTION) == []
    assert path[0] == list(START) and path[-1] == list(points[-1])
    places = [path.index(list(point), 1) for point in points]
    assert places == sorted(places)
    assert report.result.length == pytest.approx(np.hypot(*np.diff(report.path, axis=0).T).sum())
    assert report.clearance > 0.0 and report.offset == 0.0
    assert report.why.count('leg ') == 4


def test_samples_of_all_legs_are_one_forest() -> None:
    result = ask((1.5, 1.6), GOAL).result
    assert result is not None
    roots = np.flatnonzero(result.parents < 0)
    assert len(roots) == 2, 'one tree of RRT for each leg'
    assert result.samples[roots].tolist() == [list(START), [1.5, 1.6]]
    children = np.flatnonzero(result.parents >= 0)
    assert all(result.parents[children] < children)
    # No edge leads from one leg's tree into the other's.
    assert all((children < roots[1]) == (result.parents[children] < roots[1]))


def test_leg_that_fails_is_named_and_there_is_no_path() -> None:
    report = ask((1.5, 1.6), INSIDE_WALL, GOAL)
    assert report.outcome is Outcome.INVALID_GOAL
    assert report.why.startswith('leg 2 of 3: ')
    assert len(report.path) == 0


def test_pose_on_the_way_may_be_moved_within_the_tolerance() -> None:
    report = ask((1.95, 0.25), GOAL, default_tolerance=0.3)
    assert report.solved and 'moved' in report.why
    assert path_collisions(report.path, rooms() == 100, RESOLUTION) == []


def test_planner_id_names_the_algorithm_and_the_parameter_does_without_one() -> None:
    poses = [pose(*GOAL)]
    for named, expected in (('rrt', 'rrt'), ('', 'hit_and_run')):
        settings = replace(SETTINGS, algorithm='hit_and_run')
        assert request_of(goal_message(planner_id=named), poses, settings).algorithm == expected


def test_without_a_start_the_robot_is_where_it_is() -> None:
    request = request_of(goal_message(start=None), [pose(*GOAL)], SETTINGS)
    assert request.start == Pose((0.0, 0.0, 0.0), frame='base_link')


@pytest.mark.parametrize(
    ('name', 'points', 'changes'),
    [
        ('NONE', [GOAL], {}),
        ('INVALID_PLANNER', [GOAL], {'planner_id': 'GridBased'}),
        ('TF_ERROR', [GOAL], {'start': None}),
        ('START_OUTSIDE_MAP', [GOAL], {'start': OUTSIDE}),
        ('GOAL_OUTSIDE_MAP', [OUTSIDE], {}),
        ('GOAL_OUTSIDE_MAP', [OUTSIDE, GOAL], {}),
        ('START_OCCUPIED', [GOAL], {'start': INSIDE_WALL}),
        ('GOAL_OCCUPIED', [INSIDE_WALL], {}),
        ('GOAL_OCCUPIED', [GOAL, INSIDE_WALL], {}),
        ('NO_VIAPOINTS_GIVEN', [], {}),
        ('UNKNOWN', [(NAN, 1.0)], {}),
    ],
)
def test_error_code(name: str, points: list[tuple[float, float]], changes: dict) -> None:
    report = ask(*points, message=goal_message(**changes))
    assert error_of(report) == name, report.why
    assert report.solved == (name == 'NONE')
    assert len(report.why) > 10


@pytest.mark.parametrize(
    ('outcome', 'name'),
    [
        (Outcome.TIMEOUT, 'TIMEOUT'),
        (Outcome.UNREACHABLE, 'NO_VALID_PATH'),
        (Outcome.ITERATION_LIMIT, 'NO_VALID_PATH'),
        (Outcome.MAP_CHANGED, 'NO_VALID_PATH'),
        (Outcome.NO_MAP, 'UNKNOWN'),
        (Outcome.NOT_ACTIVE, 'UNKNOWN'),
        (Outcome.CANCELLED, 'UNKNOWN'),
    ],
)
def test_error_code_of_other_outcomes(outcome: Outcome, name: str) -> None:
    assert error_of(replace(ask(GOAL), outcome=outcome)) == name


def test_poses_that_are_blocked_are_those_that_cannot_be_reached() -> None:
    newest = store(rooms()).newest()
    free = np.array([START, (1.5, 1.05), (3.5, 1.05)])
    assert blocked_poses(free, 'map', newest) == []
    # The wall is between (1.5, 0.5) and (2.5, 0.5); (2, 0.5) is inside it.
    through = np.array([START, (1.5, 0.5), (2.5, 0.5), (2.0, 0.5), (NAN, 0.5), (2.5, 0.5)])
    assert blocked_poses(through, 'map', newest) == [2, 3, 4]
    assert blocked_poses(free, 'odom', newest) == [0, 1, 2]
    assert blocked_poses(np.empty((0, 2)), 'map', newest) == []


def test_poses_behind_the_robot_have_been_passed() -> None:
    points = np.array([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (NAN, 0.0)])
    assert from_robot_on(points, Pose((1.1, 0.3, 0.0))) == 1
    assert from_robot_on(points, Pose((9.0, 0.0, 0.0))) == 2


def test_parameters_for_nav2_are_parameters() -> None:
    nodes = yaml.safe_load((CONFIG / 'nav2.yaml').read_text())
    own = nodes['/**/hnr_planner']['ros__parameters']
    assert set(own) <= set(RULES)
    assert not Settings(**own).autostart
    manager = nodes['/**/lifecycle_manager_navigation']['ros__parameters']
    assert 'hnr_planner' in manager['node_names'] and 'planner_server' not in manager['node_names']
    assert manager['bond_timeout'] == 0.0


def test_behaviour_trees_for_nav2_name_algorithms() -> None:
    nodes = yaml.safe_load((CONFIG / 'nav2.yaml').read_text())
    named = nodes['/**/bt_navigator']['ros__parameters'].values()
    assert set(named) == {path.name for path in CONFIG.glob('nav2_*.xml')}
    for file in named:
        tree = ElementTree.parse(CONFIG / file)
        (plan,) = (node for node in tree.iter() if node.tag.startswith('ComputePath'))
        assert plan.get('planner_id') in ALGORITHMS
