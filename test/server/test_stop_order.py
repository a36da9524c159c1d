"""Poses in any order: the parameter ``any_order``, and when the order of the request stays."""

from dataclasses import replace
from test.brute_force import path_collisions
from test.server.test_requests import RESOLUTION, rooms, SETTINGS, store
import threading
from typing import Any

from hnr_planner.server.nav2 import goal_request
from hnr_planner.server.planning.respond import respond
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import Pose
from hnr_planner.server.responses.plan_response import PlanResponse

#: Points of the first room, in an order that turns back twice.
ZIGZAG = [(1.5, 0.3), (0.8, 0.3), (1.2, 0.3)]


def ask(points: list[tuple[float, float]], **changes: Any) -> PlanResponse:
    """Ask for a path through points in any order, from a point left of them."""
    settings = replace(SETTINGS, **{'any_order': True, **changes})
    start, *poses = (Pose((*point, 0.0), frame='map') for point in [(0.5, 0.3), *points])
    request = goal_request(start, poses, '', settings)
    return respond(request, settings, store(rooms(), settings).newest, threading.Event())


def test_poses_are_taken_in_the_shortest_order_and_the_outcome_has_it() -> None:
    response = ask(ZIGZAG)
    assert response.solved and response.why.startswith('poses in the order 2, 3, 1; leg 1: ')
    path = response.path.tolist()
    places = [path.index(list(point)) for point in (ZIGZAG[1], ZIGZAG[2], ZIGZAG[0])]
    assert places == sorted(places) and places[-1] == len(path) - 1
    assert path_collisions(response.path, rooms() == 100, RESOLUTION) == []


def test_the_order_stays_without_the_parameter() -> None:
    response = ask(ZIGZAG, any_order=False)
    assert response.solved and 'order' not in response.why
    assert response.path[-1].tolist() == list(ZIGZAG[-1])


def test_a_pose_that_cannot_be_reached_is_named_by_its_place_in_the_request() -> None:
    response = ask([(1.5, 0.3), (99.0, 0.3)])
    assert response.outcome is Outcome.INVALID_GOAL
    assert response.why.startswith('leg 2 of 2: ')


def test_a_pose_may_be_moved_within_the_tolerance() -> None:
    response = ask([(1.5, 0.3), (0.8, -0.05)], default_tolerance=0.3)
    assert response.solved and response.why.startswith('poses in the order 2, 1; ')
