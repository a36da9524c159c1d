"""A start that is not free: led out where the parameters allow it, and the response says so."""

from dataclasses import replace
import math
from test.brute_force import path_collisions
from test.server.test_requests import ask, ChangingMap, rooms, SETTINGS, store

from hnr_planner.server.requests.outcomes import Outcome
import numpy as np
import pytest

CELL = 0.1
LED_OUT = replace(SETTINGS, escape_radius=0.5, robot_radius=0.2)

#: In the last column before the wall of ``rooms``, so within the robot's radius of it.
NEAR_WALL = (1.85, 0.55)


def test_start_near_a_wall_is_led_out_and_the_words_say_so() -> None:
    data = rooms()
    refused = ask(store(data, LED_OUT), NEAR_WALL, settings=replace(LED_OUT, escape_radius=0.0))
    assert refused.outcome is Outcome.INVALID_START
    response = ask(store(data, LED_OUT), NEAR_WALL, (0.5, 1.5), settings=LED_OUT)
    assert response.outcome is Outcome.SOLVED
    assert response.path[0].tolist() == list(NEAR_WALL)
    assert response.escape == pytest.approx(math.dist(*response.path[:2]), abs=1e-12)
    assert response.escape == pytest.approx(0.15, abs=1e-3)
    assert path_collisions(response.free_path, data >= 65, CELL, robot_radius=0.2) == []
    assert path_collisions(response.path, data >= 65, CELL) == []
    words = 'moved by 0.15 m because start (1.85, 0.55) is within the robot radius'
    assert words in response.why
    assert float(response.values['escape']) == pytest.approx(0.15, abs=1e-3)
    assert response.result is not None
    steps = np.diff(response.path, axis=0)
    assert response.result.length == pytest.approx(np.hypot(*steps.T).sum())


def test_start_that_is_free_is_not_led_anywhere() -> None:
    response = ask(store(rooms()), settings=replace(SETTINGS, escape_radius=1.0))
    assert response.escape == 0.0
    assert np.array_equal(response.path, ask(store(rooms())).path)


def test_no_way_out_within_the_radius_keeps_the_name_of_the_failure() -> None:
    short = replace(LED_OUT, escape_radius=0.1)
    response = ask(store(rooms(), short), NEAR_WALL, settings=short)
    assert response.outcome is Outcome.INVALID_START
    assert 'no straight segment of 0.1 m' in response.why


def test_start_in_a_wall_is_not_led_out_of_it() -> None:
    data = np.zeros((20, 40), dtype=np.int8)
    data[:, 19:23] = 100
    settings = replace(SETTINGS, escape_radius=1.0)
    response = ask(store(data), (2.1, 1.0), (3.5, 1.0), settings=settings)
    assert response.outcome is Outcome.INVALID_START


def test_start_in_the_inflation_of_a_costmap_is_led_out_on_its_own_side() -> None:
    data = np.zeros((20, 40), dtype=np.int8)
    data[:, 17:23], data[:, 20] = 99, 100
    costmap = replace(SETTINGS, occupied_threshold=99, escape_radius=1.0)
    response = ask(store(data, costmap), (1.85, 1.0), (0.5, 1.5), settings=costmap)
    assert response.outcome is Outcome.SOLVED, response.why
    assert response.path[1].tolist() == pytest.approx([1.7, 1.0], abs=1e-3)
    far = ask(store(data, costmap), (1.85, 1.0), (3.5, 1.5), settings=costmap)
    assert far.outcome is Outcome.UNREACHABLE


def test_way_out_and_tolerance_go_together() -> None:
    maps = store(rooms(), LED_OUT)
    response = ask(maps, NEAR_WALL, (1.85, 1.7), tolerance=0.3, settings=LED_OUT)
    assert response.outcome is Outcome.SOLVED
    assert 'start was moved' in response.why and 'goal was moved' in response.why


def test_newer_map_with_another_way_out_gets_another_path() -> None:
    """On the newer map the start is free: the first segment is none that leads it out."""
    maps = ChangingMap(store(rooms(), LED_OUT), np.zeros((20, 40), dtype=np.int8))
    response = ask(maps, NEAR_WALL, (0.5, 1.5), settings=LED_OUT)
    assert response.outcome is Outcome.SOLVED
    assert response.escape == 0.0
    assert response.path.tolist() == [list(NEAR_WALL), [0.5, 1.5]]
