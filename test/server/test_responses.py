"""What is told about answers: the values of an outcome, and the statistics."""

from dataclasses import astuple, replace
from test.server.test_planning_server import REQUEST, server
from test.server.test_requests import ask, maze, rooms, SETTINGS, store
import time

from hnr_planner.server.outcomes import Outcome
from hnr_planner.server.statistics import Statistics
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
