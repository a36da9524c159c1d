"""The last path, checked on every map that comes."""

from test.server.test_requests import ask, receive, rooms, store
import weakref

from hnr_planner.server.map.map_store import MapStore
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.validity.path_monitor import PathMonitor
import pytest

Report = tuple[bool, str, PlanResponse | None]


@pytest.fixture
def maps() -> MapStore:
    """Return a store with a map."""
    return store(rooms())


@pytest.fixture
def reports() -> list[Report]:
    """Return what a monitor has reported."""
    return []


@pytest.fixture
def monitor(maps: MapStore, reports: list[Report]) -> PathMonitor:
    """Return a monitor that follows a path."""
    monitor = PathMonitor(maps.newest, lambda *report: reports.append(report))
    monitor.follow(ask(maps))
    return monitor


def test_path_that_was_found_is_free(monitor: PathMonitor, reports: list[Report]) -> None:
    assert reports == [(True, '', None)]
    monitor.check()
    assert len(reports) == 1, 'nothing has changed'


def test_map_that_blocks_the_path_is_reported_once_with_the_place(
    maps: MapStore, monitor: PathMonitor, reports: list[Report]
) -> None:
    for data in (rooms(door=False), rooms(door=False)):
        data[0, 0] = 100 * (len(reports) % 2)
        receive(maps, data)
        monitor.check()
    valid, why, changed = reports[1]
    assert len(reports) == 2 and not valid
    assert changed is not None and changed.outcome is Outcome.MAP_CHANGED
    assert changed.blocked is not None and changed.blocked.x == pytest.approx(1.9, abs=1e-6)
    assert why == changed.why and changed.frame == 'map'


def test_map_that_frees_the_path_again_is_reported(
    maps: MapStore, monitor: PathMonitor, reports: list[Report]
) -> None:
    for data in (rooms(door=False), rooms()):
        receive(maps, data)
        monitor.check()
    valid, why, changed = reports[-1]
    assert valid and 'free again' in why and changed is None


def test_path_that_is_forgotten_is_not_valid(
    maps: MapStore, monitor: PathMonitor, reports: list[Report]
) -> None:
    monitor.forget()
    assert reports[-1] == (False, '', None)
    receive(maps, rooms(door=False))
    monitor.check()
    monitor.forget()
    assert len(reports) == 2


def test_failure_ends_the_monitoring(
    maps: MapStore, monitor: PathMonitor, reports: list[Report]
) -> None:
    monitor.follow(ask(maps, goal=(2.0, 0.2)))
    assert reports[-1] == (False, '', None)


def test_monitor_keeps_no_map(maps: MapStore, monitor: PathMonitor) -> None:
    """A large map would stay in memory for as long as nobody asks for another path."""
    old = weakref.ref(maps.newest().space)
    receive(maps, rooms(door=False))
    monitor.check()
    assert old() is None
