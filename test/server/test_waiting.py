"""A request that comes before the first map waits for it."""

from dataclasses import replace
from test.server.test_requests import ask, receive, rooms, SETTINGS
import threading

from hnr_planner.server.map.map_store import MapSnapshot, MapStore
from hnr_planner.server.map.waiting import wait_for_map
from hnr_planner.server.requests.outcomes import Outcome, Refusal
from hnr_planner.server.sampling import draw
import pytest

PATIENT = replace(SETTINGS, map_wait=3600.0)


class LateMap:
    """A store without a map, into which one comes when it has been asked ``asked`` times."""

    def __init__(self, asked: int) -> None:
        self._maps, self._left = MapStore(PATIENT), asked

    def __call__(self) -> MapSnapshot:
        """Return the map in use, or raise Refusal."""
        self._left -= 1
        if self._left == 0:
            receive(self._maps, rooms())
        return self._maps.newest()


def test_path_is_planned_on_the_map_that_came_late() -> None:
    assert ask(LateMap(5), settings=PATIENT).outcome is Outcome.SOLVED


def test_draws_are_of_the_map_that_came_late() -> None:
    response = draw(replace(PATIENT, sample_count=3), LateMap(5), threading.Event())
    assert response.outcome is Outcome.SAMPLED and len(response.points) == 3


def test_wait_ends_after_map_wait() -> None:
    short = replace(SETTINGS, map_wait=0.05)
    response = ask(MapStore(short), settings=short)
    assert response.outcome is Outcome.NO_MAP
    assert response.elapsed >= 0.05


def test_wait_ends_within_the_time_limit() -> None:
    short = replace(PATIENT, time_limit=0.05)
    assert ask(MapStore(short), settings=short).outcome is Outcome.NO_MAP


def test_wait_can_be_cancelled() -> None:
    cancel = threading.Event()
    threading.Timer(0.05, cancel.set).start()
    with pytest.raises(Refusal) as refusal:
        wait_for_map(MapStore(PATIENT).newest, 3600.0, cancel)
    assert refusal.value.outcome is Outcome.CANCELLED


def test_node_that_is_not_active_is_not_waited_for() -> None:
    def newest() -> MapSnapshot:
        raise Refusal(Outcome.NOT_ACTIVE, 'not active')

    assert ask(newest, settings=PATIENT).outcome is Outcome.NOT_ACTIVE
