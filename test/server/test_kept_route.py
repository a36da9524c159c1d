"""A route stays while the map changes a little, and gives way to a much shorter one."""

from dataclasses import replace
from itertools import pairwise
import math
from test.brute_force import path_collisions
from test.server.test_planning_server import server
from test.server.test_requests import receive, RESOLUTION, SETTINGS, store

from hnr_planner.core import GridSpace
from hnr_planner.core.lengths import path_length
from hnr_planner.server.kept_route import mend, next_vertex
from hnr_planner.server.outcomes import Outcome
from hnr_planner.server.planning_server import PlanningServer
from hnr_planner.server.requests import PlanRequest, Pose
from hnr_planner.server.respond import only_same_frame
from hnr_planner.server.responses import PlanResponse
import numpy as np
import pytest

#: Two ways around an island, of nearly the same length: which is shorter depends on the door.
SHAPE, ISLAND = (40, 60), np.s_[10:30, 20:40]
START, GOAL = (0.5, 2.0), (5.5, 2.0)


def island(lower: int = 0, upper: int = 0) -> np.ndarray:
    """Return a room with an island; the ways below and above it are narrowed by so many cells."""
    data = np.zeros(SHAPE, dtype=np.int8)
    data[ISLAND] = 100
    below, above = 10 - lower, 30 + upper
    data[below:10, 20:40] = data[30:above, 20:40] = 100
    return data


def request(start: tuple[float, float] = START) -> PlanRequest:
    """Return a request from a start to the same goal."""
    return PlanRequest(Pose((*start, 0.0)), Pose((*GOAL, 0.0)), 0.0, 'auto')


class Robot:
    """Asks again and again while the map changes."""

    def __init__(self, ratio: float) -> None:
        self.maps = store(island())
        settings = replace(SETTINGS, keep_route=ratio, optimize_for=10.0, algorithm='auto')
        self.server = PlanningServer(lambda: settings, self.maps.newest, only_same_frame, print)
        self.server.searches.enable()

    def ask(self, data: np.ndarray, start: tuple[float, float] = START) -> PlanResponse:
        """Put a map to use and return the response to a request, whose path is free there."""
        receive(self.maps, data)
        response = self.server.plan(request(start))
        assert response.outcome is Outcome.SOLVED
        assert path_collisions(response.path, data >= 65, RESOLUTION) == []
        assert response.path[0].tolist() == list(start)
        assert response.path[-1].tolist() == list(GOAL)
        return response


def is_above(response: PlanResponse) -> bool:
    """Return whether a path passes above the island."""
    path = response.path
    return bool(np.interp(3.0, path[:, 0], path[:, 1]) > 2.0)


def test_route_stays_on_its_side_while_the_shorter_side_changes() -> None:
    changes = [(int(n % 2) * 2, int(1 - n % 2) * 2) for n in range(10)]
    sides = {}
    for ratio in (0.0, 0.2):
        robot = Robot(ratio)
        sides[ratio] = [is_above(robot.ask(island(*change))) for change in changes]
    switches = {ratio: sum(a != b for a, b in pairwise(side)) for ratio, side in sides.items()}
    assert switches == {0.0: 9, 0.2: 0}


def test_outcome_says_kept_mended_or_new_and_why() -> None:
    robot = Robot(0.2)
    assert robot.ask(island()).values['route'] == 'new'
    again = robot.ask(island(), start=(0.7, 2.0))
    assert again.values['route'] == 'kept'
    assert 'the route is kept: it is longer than a new one by' in again.why
    above = is_above(again)
    narrowed = island(upper=3) if above else island(lower=3)
    mended = robot.ask(narrowed, start=(0.7, 2.0))
    assert mended.values['route'] == 'mended' and is_above(mended) is above
    closed = island(upper=10) if above else island(lower=10)
    other = robot.ask(closed, start=(0.7, 2.0))
    assert is_above(other) is not above


def test_much_shorter_path_is_taken() -> None:
    robot = Robot(0.05)
    robot.ask(island())
    free = robot.ask(np.zeros(SHAPE, dtype=np.int8))
    assert free.values['route'] == 'new' or path_length(free.path) < 5.0 / 0.95
    assert path_length(free.path) <= 5.0 / 0.95 + 1e-9


def test_route_of_another_goal_or_without_the_parameter_is_not_kept() -> None:
    robot = Robot(0.2)
    robot.ask(island())
    elsewhere = replace(request(), goal=Pose((5.5, 3.0, 0.0)))
    assert robot.server.plan(elsewhere).values['route'] == 'new'
    assert 'route' not in server(store(island()).newest).plan(request()).values


def test_path_with_a_kept_route_is_hardly_longer_than_the_shortest() -> None:
    """Random narrowings: on average within 2 %, and each within the ratio."""
    rng, robot, ratio = np.random.default_rng(5), Robot(0.1), 0.1
    excess = []
    for _ in range(30):
        data = island(*rng.integers(0, 4, 2).tolist())
        response = robot.ask(data)
        shortest = Robot(0.0).ask(data)
        excess.append(path_length(response.path) / path_length(shortest.path))
    assert max(excess) <= 1.0 / (1.0 - ratio) + 1e-6
    assert np.mean(excess) <= 1.02


def test_next_vertex_is_ahead_of_the_robot() -> None:
    path = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]])
    assert next_vertex(path, np.array([0.5, 0.1])) == 1
    assert next_vertex(path, np.array([2.1, 0.5])) == 2
    assert next_vertex(path, np.array([2.0, 0.0])) == 2, 'a vertex that is reached is passed'
    assert next_vertex(path, np.array([9.0, 9.0])) == 2


@pytest.mark.parametrize('goal_blocked', [False, True])
def test_path_that_cannot_be_connected_is_not_mended(goal_blocked: bool) -> None:
    blocked = np.zeros((4, 8), dtype=bool)
    blocked[:, 7 if goal_blocked else 4] = True
    space = GridSpace.from_blocked(blocked)
    last = np.array([[0.5, 2.0], [7.5, 2.0]])
    assert mend(last, np.array([1.0, 2.0]), space, lambda _start, _goal: None) is None
    assert math.isclose(path_length(last), 7.0)
