"""The roadmap of the newest map: built beside requests, repaired, and never of another map."""

from collections.abc import Iterator
from dataclasses import replace
from test.brute_force import path_collisions
from test.ros.harness import until
from test.server.test_planning_server import REQUEST
from test.server.test_requests import receive, RESOLUTION, rooms, SETTINGS, store

from hnr_planner.server.map.roadmaps import Roadmaps
from hnr_planner.server.planning.respond import only_same_frame
from hnr_planner.server.planning_server import PlanningServer
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import PlanRequest
import pytest

AUTO = replace(REQUEST, algorithm='auto')


@pytest.fixture
def defects() -> list[str]:
    """Return the tracebacks of roadmaps that could not be made."""
    return []


@pytest.fixture
def roadmaps(defects: list[str]) -> Iterator[Roadmaps]:
    """Return a keeper of roadmaps, which ends with the test."""
    made = Roadmaps(defects.append)
    yield made
    made.forget()
    assert defects == []


def test_roadmap_is_built_then_repaired_for_each_newer_map(roadmaps: Roadmaps) -> None:
    maps = store(rooms())
    assert roadmaps.state.state == 'off' and roadmaps.state.n_bytes == 0
    roadmaps.follow(maps.newest())
    first = maps.newest()
    until(lambda: roadmaps.of(first), 'a roadmap', timeout=300.0)
    assert roadmaps.state.state == 'ready'
    assert roadmaps.state.build_time > 0.0 and roadmaps.state.n_bytes > 1000
    receive(maps, rooms(door=False))
    second = maps.newest()
    assert roadmaps.of(second) is None, 'never that of another map'
    roadmaps.follow(second)
    until(lambda: roadmaps.of(second), 'a repaired roadmap', timeout=300.0)
    assert roadmaps.of(first) is None
    assert roadmaps.state.update_time > 0.0
    roadmaps.forget()
    assert roadmaps.of(second) is None and roadmaps.state.state == 'off'


def test_requests_use_the_roadmap_once_it_is_ready_and_do_not_wait() -> None:
    maps, data = store(rooms()), rooms()
    settings = replace(SETTINGS, roadmap=True)
    server = PlanningServer(lambda: settings, maps.newest, only_same_frame, print)
    server.searches.enable()
    assert server.plan(AUTO).algorithm != 'roadmap'
    server.follow_map()
    assert server.plan(AUTO).outcome is Outcome.SOLVED
    until(lambda: server.roadmaps.of(maps.newest()), 'a roadmap', timeout=300.0)

    def planned(request: PlanRequest) -> str:
        response = server.plan(request)
        assert response.outcome is Outcome.SOLVED
        assert path_collisions(response.path, data >= 65, RESOLUTION) == []
        return response.algorithm

    assert planned(AUTO) == 'roadmap'
    assert planned(REQUEST) == REQUEST.algorithm == 'rrt', 'what is asked for by name'
    settings = replace(settings, roadmap=False)
    server.follow_map()
    assert planned(AUTO) != 'roadmap'
