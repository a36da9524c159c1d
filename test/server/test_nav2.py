"""Goals of Nav2 as requests and outcomes as its error codes, without Nav2."""

from dataclasses import replace
from pathlib import Path
from test.brute_force import path_collisions
from test.server.test_requests import GOAL, RESOLUTION, rooms, SETTINGS, store
import threading
from typing import Any
from xml.etree import ElementTree

from hnr_planner.core import ALGORITHMS
from hnr_planner.server.nav2 import error_name, goal_request
from hnr_planner.server.parameters.settings import DEFAULTS, RULES, Settings
from hnr_planner.server.planning.respond import respond
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import Pose
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.validity.path_validity import blocked_poses, judge_path, nearest_pose
import numpy as np
import pytest
import yaml

CONFIG = Path(__file__).parents[2] / 'config'
START = (0.5, 0.5)
INSIDE_WALL, OUTSIDE = (2.0, 0.25), (9.0, 0.5)
NAN = float('nan')


def pose(point: tuple[float, float]) -> Pose:
    """Return a pose of the map's frame."""
    return Pose((*point, 0.0), frame='map')


def ask(
    *points: tuple[float, float],
    start: tuple[float, float] | None = START,
    planner_id: str = '',
    **settings: Any,
) -> PlanResponse:
    """Ask for a path through points, from the robot without a start; return how that ended."""
    own = replace(SETTINGS, **settings)
    begin = None if start is None else pose(start)
    request = goal_request(begin, [pose(point) for point in points], planner_id, own)
    return respond(request, own, store(rooms()).newest, threading.Event())


def test_path_meets_all_poses_in_their_order() -> None:
    points = [(1.5, 1.6), (3.6, 1.7), GOAL, START]
    response = ask(*points)
    assert response.solved and response.result is not None, response.why
    path = response.path.tolist()
    assert path_collisions(response.path, rooms() == 100, RESOLUTION) == []
    assert path[0] == list(START) and path[-1] == list(points[-1])
    places = [path.index(list(point), 1) for point in points]
    assert places == sorted(places)
    assert response.result.length == pytest.approx(
        np.hypot(*np.diff(response.path, axis=0).T).sum()
    )
    assert response.clearance > 0.0 and response.offset == 0.0
    assert response.why.count('leg ') == 4


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
    response = ask((1.5, 1.6), INSIDE_WALL, GOAL)
    assert response.outcome is Outcome.INVALID_GOAL
    assert response.why.startswith('leg 2 of 3: ')
    assert len(response.path) == 0


def test_pose_on_the_way_may_be_moved_within_the_tolerance() -> None:
    response = ask((1.95, 0.25), GOAL, default_tolerance=0.3)
    assert response.solved and 'moved' in response.why
    assert path_collisions(response.path, rooms() == 100, RESOLUTION) == []


def test_planner_id_names_the_algorithm_and_the_parameter_does_without_one() -> None:
    settings = replace(
        SETTINGS, algorithm='hit_and_run', planner_aliases=('GridBased:rrt_connect', 'rrt:auto')
    )
    for named, expected in (
        ('hit_and_run', 'hit_and_run'),
        ('', 'hit_and_run'),
        ('GridBased', 'rrt_connect'),
        ('rrt', 'auto'),
        ('kinodynamic_connect', 'kinodynamic_connect'),
    ):
        request = goal_request(None, [pose(GOAL)], named, settings)
        assert request.algorithm == expected


def test_names_of_nav2_stand_for_the_best_planner_by_default() -> None:
    assert DEFAULTS.aliases == {'GridBased': 'auto'}
    assert ask(GOAL, planner_id='GridBased').solved


def test_robot_with_inertia_is_served_to_one_pose_only() -> None:
    response = ask(GOAL, planner_id='kinodynamic_connect', time_limit=60.0)
    assert response.solved and error_name(response) == 'NONE'
    assert response.path[0].tolist() == list(START)
    refused = ask((1.5, 1.6), GOAL, planner_id='kinodynamic_connect')
    assert refused.outcome is Outcome.BAD_REQUEST and 'on the way' in refused.why
    assert refused.result is None, 'nothing was planned'
    assert error_name(refused) == 'INVALID_PLANNER'


def test_without_a_start_the_robot_is_where_it_is() -> None:
    request = goal_request(None, [pose(GOAL)], '', SETTINGS)
    assert request.start == Pose((0.0, 0.0, 0.0), frame='base_link')


@pytest.mark.parametrize(
    ('name', 'points', 'changes'),
    [
        ('NONE', [GOAL], {}),
        ('INVALID_PLANNER', [GOAL], {'planner_id': 'NavFn'}),
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
    response = ask(*points, **changes)
    assert error_name(response) == name, response.why
    assert response.solved == (name == 'NONE')
    assert len(response.why) > 10


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
    assert error_name(replace(ask(GOAL), outcome=outcome)) == name


def test_poses_that_are_blocked_are_those_that_cannot_be_reached() -> None:
    newest = store(rooms()).newest()
    free = np.array([START, (1.5, 1.05), (3.5, 1.05)])
    assert blocked_poses(free, 'map', newest) == []
    # The wall is between (1.5, 0.5) and (2.5, 0.5); (2, 0.5) is inside it.
    through = np.array([START, (1.5, 0.5), (2.5, 0.5), (2.0, 0.5), (NAN, 0.5), (2.5, 0.5)])
    assert blocked_poses(through, 'map', newest) == [2, 3, 4]
    assert blocked_poses(free, 'odom', newest) == [0, 1, 2]
    assert blocked_poses(np.empty((0, 2)), 'map', newest) == []


def test_path_that_is_not_valid_has_a_reason() -> None:
    newest = store(rooms()).newest()
    free = np.array([START, (1.5, 1.05), (3.5, 1.05)])
    assert judge_path(free, '', newest, None) == ([], '')
    assert judge_path(np.empty((0, 2)), 'map', newest, None).why == 'the path has no poses'
    other = judge_path(free, 'odom', newest, None)
    assert other.blocked == [0, 1, 2] and "'odom'" in other.why and "'map'" in other.why
    through = np.array([START, (1.5, 0.5), (2.5, 0.5)])
    verdict = judge_path(through, 'map', newest, None)
    assert verdict.blocked == [2] and 'pose 2 of 3, at (2.5, 0.5)' in verdict.why
    assert judge_path(through, 'map', newest, Pose((2.6, 0.5, 0.0))).blocked == [2]
    assert judge_path(through[:2], 'map', newest, None).why == ''
    # What the robot has passed does not count.
    behind = np.array([(2.0, 0.5), (2.5, 0.5), (3.5, 0.5)])
    assert judge_path(behind, 'map', newest, None).blocked == [0]
    assert judge_path(behind, 'map', newest, Pose((3.4, 0.5, 0.0))) == ([], '')


def test_poses_behind_the_robot_have_been_passed() -> None:
    points = np.array([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (NAN, 0.0)])
    assert nearest_pose(points, Pose((1.1, 0.3, 0.0))) == 1
    assert nearest_pose(points, Pose((9.0, 0.0, 0.0))) == 2


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
