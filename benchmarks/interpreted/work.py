"""Work that runs interpreted, and how late it ends after a time limit and a cancellation."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
import threading
import time
from typing import Any, NamedTuple

from benchmarks.problems import Floats, OFFICE, ROBOT_RADIUS
from hnr_planner.core import ALGORITHMS, GridSpace, KINODYNAMIC_PLANNERS, plan
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import make_problem
from hnr_planner.core.planning.planners.flood_fill import FloodFill
from hnr_planner.core.spaces.grid.components import nearest_in_component
from hnr_planner.core.spaces.grid.slabs import build_slabs
from hnr_planner.experiments.requests import far_pairs
from hnr_planner.maps import load_map, OccupancyMap
from hnr_planner.server.map.map_store import MapStore
from hnr_planner.server.parameters.settings import DEFAULTS, Settings
from hnr_planner.server.planning.respond import respond
from hnr_planner.server.requests.plan_request import PlanRequest, Pose
from hnr_planner.server.sampling import draw
import numpy as np

#: Side [cells] and number of boxes of the map that is made here.
SIDE, CLUTTER = 1000, 600
#: Work is ended after so long [s], by turns sooner and later.
SHORTEST, LONGEST = 0.05, 0.3
#: Time limit [s] of work that is cancelled.
LONG = 60.0
#: A goal outside of the maps.
FAR_AWAY = Pose((200.0, -100.0, 0.0))
#: Settings of every request: the search for shorter paths goes on until the time is up.
SETTINGS = replace(
    DEFAULTS, robot_radius=ROBOT_RADIUS['office'], goal_radius=0.3, seed=0, optimize_for=LONG
)

#: Work as a function of its time limit [s], an event that cancels it, and the number of the run.
Work = Callable[[float, threading.Event, int], Any]


class Lateness(NamedTuple):
    """Times [s] from when work had to end until it did: after a time limit, or a cancellation."""

    group: str
    place: str
    limit: list[float]
    cancel: list[float]


def office() -> OccupancyMap:
    """Return the map of the office."""
    return load_map(OFFICE)


def boxes() -> OccupancyMap:
    """Return a large yard full of boxes."""
    rng = np.random.default_rng(0)
    data = np.zeros((SIDE, SIDE), dtype=np.int8)
    for row, column, *size in rng.integers((0, 0, 2, 2), (SIDE, SIDE, 40, 40), (CLUTTER, 4)):
        data[row:, column:][: size[0], : size[1]] = 100
    return OccupancyMap(data, 0.05)


MAPS = {'office': office, f'boxes {SIDE}^2': boxes}


def measure(name: str, n_runs: int) -> Iterator[Lateness]:
    """Measure all groups of work on one map."""
    maps = MapStore(SETTINGS)
    maps.receive(MAPS[name])
    space = maps.newest().space
    pairs = far_pairs(space, n_runs, seed=0)
    for group, works in _groups(maps, space, pairs).items():
        entry = Lateness(group, name, [], [])
        for work in works:
            for k in range(n_runs):
                seconds = SHORTEST + (LONGEST - SHORTEST) * k / n_runs
                entry.limit.extend(_overrun(work, seconds, k))
                entry.cancel.extend(_after_cancellation(work, seconds, k))
        yield entry


def _overrun(work: Work, limit: float, k: int) -> Iterator[float]:
    """Yield by how much a run overran its time limit, if it did not end before."""
    began = time.perf_counter()
    work(limit, threading.Event(), k)
    late = time.perf_counter() - began - limit
    if late >= 0.0:
        yield late


def _after_cancellation(work: Work, seconds: float, k: int) -> Iterator[float]:
    """Yield how long a run went on after it was cancelled, if it did not end before."""
    cancel, due = threading.Event(), []

    def end() -> None:
        due.append(time.perf_counter())
        cancel.set()

    timer = threading.Timer(seconds, end)
    timer.start()
    work(LONG, cancel, k)
    ended = time.perf_counter()
    timer.cancel()
    timer.join()
    yield from (ended - then for then in due)


def _groups(maps: MapStore, space: GridSpace, pairs: Floats) -> dict[str, list[Work]]:
    """Return the work to measure, by what it has in common."""

    def request(algorithm: str, limit: float, cancel: threading.Event, k: int) -> None:
        start, goal = map(_pose, pairs[k])
        settings = replace(SETTINGS, time_limit=limit, optimize_for=limit)
        asked = PlanRequest(start, goal, 0.0, algorithm)
        respond(asked, settings, maps.newest, cancel)

    def far_goal(limit: float, cancel: threading.Event, k: int) -> None:
        settings = replace(SETTINGS, goal_radius=0.0, time_limit=limit)
        asked = PlanRequest(_pose(pairs[k, 0]), FAR_AWAY, 1000.0, 'auto')
        respond(asked, settings, maps.newest, cancel)

    def draws(limit: float, cancel: threading.Event, k: int) -> None:
        settings: Settings = replace(SETTINGS, time_limit=limit, sample_count=100_000, seed=k)
        draw(settings, maps.newest, cancel)

    def options(more: dict[str, Any], limit: float, cancel: threading.Event, k: int) -> None:
        plan(space, *pairs[k], seed=k, time_limit=limit, cancel=cancel, **more)

    def kernel(call: Callable[[int], Any], limit: float, cancel: threading.Event, k: int) -> None:
        Budget(working_time() + limit, cancel=cancel).within(lambda: call(k), None)

    def flooded(k: int) -> None:
        fill = FloodFill(make_problem(space, pairs[k, 0], pairs[k, 1], 0.0))
        fill.advance(space.data.labels.size)

    def nearest(_k: int) -> None:
        nearest_in_component(space.data.labels, 1, np.array(FAR_AWAY.point), space.margin)

    loops = (flooded, nearest, lambda _: build_slabs(space.data.free_distance))
    more = ({'alternatives': 3}, {'clearance': 0.5, 'optimize_iterations': 100})
    return {
        'paths': [
            *(partial(request, name) for name in ALGORITHMS),
            *(partial(options, option) for option in more),
            far_goal,
        ],
        'motions': [partial(request, name) for name in KINODYNAMIC_PLANNERS],
        'draws': [draws],
        'flood fill, nearest point, slabs': [partial(kernel, loop) for loop in loops],
    }


def _pose(point: Floats) -> Pose:
    return Pose((float(point[0]), float(point[1]), 0.0))
