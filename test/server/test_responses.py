"""What is told about answers: the values of an outcome, and the statistics."""

from dataclasses import astuple, replace
from test.brute_force import path_collisions
from test.server.test_planning_server import REQUEST, server
from test.server.test_requests import ask, maze, receive, RESOLUTION, rooms, SETTINGS, store
import time

from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.responses.statistics import Statistics
import numpy as np
import pytest


@pytest.mark.parametrize('outcome', [Outcome.UNREACHABLE, Outcome.ITERATION_LIMIT])
def test_without_a_path_its_measures_are_not_numbers(outcome: Outcome) -> None:
    if outcome is Outcome.UNREACHABLE:
        response = ask(store(rooms(door=False)))
    else:
        settings = replace(SETTINGS, max_iterations=100)
        response = ask(store(maze()), (0.05, 0.05), (20.05, 20.05), settings=settings)
    assert response.outcome is outcome
    values = response.values
    assert [values[name] for name in ('length', 'clearance', 'offset')] == ['nan'] * 3
    assert values['first_solution_length'] == 'nan'


def test_times_of_the_phases_add_up_to_the_time_of_a_request() -> None:
    response = ask(store(rooms()), settings=replace(SETTINGS, optimize_for=0.05))
    times = response.times
    assert min(astuple(times)) > 0.0
    assert sum(astuple(times)) <= response.elapsed
    sent = response.sent_after(0.5)
    assert sent.elapsed == response.elapsed + 0.5
    assert sent.times.message_time == times.message_time + 0.5
    assert response.values['search_time'] == f'{times.search_time:.6f}'


def island() -> np.ndarray:
    """Return a room with an island in its middle, which is passed on two sides."""
    data = np.zeros((40, 40), dtype=np.int8)
    data[12:26, 15:25] = 100
    return data


def test_alternatives_pass_on_different_sides_and_keep_clear() -> None:
    settings = replace(SETTINGS, alternatives=3, clearance=0.3)
    response = ask(store(island()), (0.5, 2.0), (3.5, 2.0), settings=settings)
    paths = [rows[:, :2] for rows in response.poses_of_all]
    assert len(paths) == 2, 'there are no more'
    above = [path[np.abs(path[:, 0] - 2.0).argmin(), 1] > 1.9 for path in paths]
    assert sorted(above) == [False, True]
    for path in paths:
        assert path_collisions(path, island() >= 65, RESOLUTION) == []
        assert path[[0, -1]].tolist() == [[0.5, 2.0], [3.5, 2.0]]
    assert response.clearance > 0.25
    assert response.values['alternatives'] == '2'
    lengths = [float(n) for n in response.values['alternative_lengths'].split()]
    assert lengths == sorted(lengths)
    assert lengths[0] == pytest.approx(float(response.values['length']), rel=1e-5)


def test_alternative_that_a_newer_map_blocks_is_left_out() -> None:
    settings, closed = replace(SETTINGS, alternatives=2), island()
    closed[26:, 20] = 100
    maps, newest = store(island()), []

    def newest_map() -> MapSnapshot:
        newest.append(maps.newest())
        if len(newest) == 1:
            receive(maps, closed)
        return newest[-1]

    response = ask(newest_map, (0.5, 1.0), (3.5, 1.0), settings=settings)
    assert response.snapshot is maps.newest()
    assert response.values['alternatives'] == '1'


def test_time_of_a_request_begins_with_its_arrival() -> None:
    planned = server(store(rooms()).newest).plan(REQUEST, arrived=time.monotonic() - 5.0)
    assert planned.elapsed >= 5.0


def test_refusals_are_counted_and_leave_the_times_alone() -> None:
    statistics = Statistics()
    searched = ask(store(rooms()))
    statistics.count(searched)
    for start, goal in (((2.0, 0.2), (3.5, 0.3)), ((0.5, 0.5), (2.0, 0.2))):
        statistics.count(ask(store(rooms()), start, goal))
    statistics.count(ask(store(rooms(door=False))))
    summary = statistics.summary()
    assert summary.outcomes == {
        Outcome.SOLVED: 1,
        Outcome.INVALID_START: 1,
        Outcome.INVALID_GOAL: 1,
        Outcome.UNREACHABLE: 1,
    }
    assert summary.median == summary.p95 == searched.elapsed


def test_times_are_unknown_before_the_first_search() -> None:
    statistics = Statistics()
    statistics.count(ask(store(rooms(door=False))))
    assert np.isnan([statistics.summary().median, statistics.summary().p95]).all()
