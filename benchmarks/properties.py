"""Section: ours alone; overhead, preparing a map, growth with its size, keeping to limits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from statistics import median
import threading
import time
from typing import Any

from benchmarks.problems import OFFICE
from benchmarks.progress import show
from benchmarks.sections import Bench, Section, Verdict, verdict_table
import cv2
from hnr_planner.core import GridSpace, plan
from hnr_planner.experiments.requests import far_pairs
from hnr_planner.maps import load_map, spiral
import numpy as np
from numpy.typing import NDArray

#: Side [cells] of the coarsest building, and how often each cell of it is repeated.
BUILDING, ENLARGED = 500, (1, 4, 16)
#: Side of the map whose preparation is timed [cells].
READY_SIDE = 4000
#: A call that had no core for longer than this [s] is counted apart.
LOST = 0.2e-3


def properties(bench: Bench) -> Section:
    """Return the section on calls, preparation of maps, growth and limits of our planner."""
    measured = []
    for verdict in _measure(bench.quick):
        show(f'{verdict.what}: {verdict.measured}')
        measured.append(verdict)
    return Section('Ours alone', verdict_table(measured), measured)


def _measure(quick: bool) -> Iterator[Verdict]:
    yield _overhead(2000 if quick else 20_000)
    yield from _readiness(2 if quick else 7)
    yield _growth(ENLARGED[:2] if quick else ENLARGED, 200 if quick else 1000)
    yield _time_limit(40 if quick else 200)
    yield _cancellation(40 if quick else 200)


def _overhead(n_calls: int) -> Verdict:
    space = GridSpace.from_blocked(np.zeros((100, 100), dtype=bool))
    times = [_timed(lambda: plan(space, (10.0, 10.0), (90.0, 80.0))) for _ in range(n_calls)]
    typical = 1e6 * median(times)
    measured = f'{typical:.1f} us (p95 {1e6 * np.quantile(times, 0.95):.1f})'
    return Verdict('call of plan() on an empty map', '30 us', measured, typical <= 30.0)


def _office(side: int) -> NDArray[np.int8]:
    """Draw the office map with (side, side) cells; its cells become rectangles."""
    data = load_map(OFFICE).data
    rows, columns = (np.arange(side) * length // side for length in data.shape)
    return data[np.ix_(rows, columns)]


def _readiness(n_repeats: int) -> Iterator[Verdict]:
    data = np.kron(_office(BUILDING), np.ones((READY_SIDE // BUILDING,) * 2, dtype=np.int8))
    free = (data < 65).astype(np.uint8)
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    for radius in (0.0, 0.22):
        exact, ours = [], []
        for _ in range(n_repeats):
            exact.append(
                _timed(lambda: cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE))
            )
            ours.append(
                _timed(lambda r=radius: GridSpace.from_occupancy(data, 0.05, robot_radius=r))
            )
        factor = median(ours) / median(exact)
        yield Verdict(
            f'a map of {READY_SIDE}^2 cells ready, robot radius {radius:g} m',
            "3 x OpenCV's exact distance transform",
            f'{1e3 * median(ours):.0f} ms, {factor:.2f} x',
            factor <= 3.0,
        )
    cv2.setNumThreads(threads)
    space = GridSpace.from_occupancy(data, 0.05)
    arrays = (*space.data, space.walls)
    n_bytes = sum(array.nbytes for array in arrays) / data.size
    measured = f'{n_bytes:.1f}'
    yield Verdict('memory of a ready map', '12 bytes a cell', measured, n_bytes <= 12.0)


def _growth(factors: tuple[int, ...], n_runs: int) -> Verdict:
    """Time the same requests in the same building, with the cells of the coarsest repeated."""
    coarse = _office(BUILDING)
    requests = far_pairs(GridSpace.from_occupancy(coarse, 1.0), 10, seed=0)
    typical = []
    for factor in factors:
        data = np.kron(coarse, np.ones((factor, factor), dtype=np.int8))
        space = GridSpace.from_occupancy(data, 1.0 / factor)
        times = [
            _timed(lambda s=space, k=k: plan(s, *requests[k % 10], simplify=False, seed=k))
            for k in range(n_runs)
        ]
        typical.append(median(times))
    sizes = ', '.join(f'{BUILDING * factor}^2' for factor in factors)
    each = ', '.join(f'{1e3 * seconds:.3f}' for seconds in typical)
    factor = max(typical) / typical[0]
    measured = f'{each} ms for {sizes} cells: {factor:.2f} x'
    return Verdict('growth of the time to the first path', '4 x', measured, factor <= 4.0)


def _endless() -> tuple[GridSpace, Any, Any]:
    """Return a space and a request that no planner can solve in the times used here."""
    made = spiral(0.12)
    return GridSpace.from_blocked(made.blocked, made.resolution), made.start, made.goal


def _time_limit(n_calls: int) -> Verdict:
    space, start, goal = _endless()
    worst = {}
    for algorithm in ('auto', 'hit_and_run', 'rrt'):
        late = _Lateness()
        for k in range(n_calls):
            limit = 0.005 + 0.02 * k / n_calls
            due = [time.perf_counter() + limit]
            with late.one(due):
                plan(space, start, goal, algorithm=algorithm, time_limit=limit, seed=k)
        worst[algorithm] = late
    return _summed('time limit overrun, p99', worst, 2.0)


def _cancellation(n_calls: int) -> Verdict:
    space, start, goal = _endless()
    worst = {}
    for algorithm in ('auto', 'hit_and_run', 'rrt'):
        late = _Lateness()
        for k in range(n_calls):
            cancel, due = threading.Event(), []
            timer = threading.Timer(0.005 + 0.01 * k / n_calls, _cancel, (cancel, due))
            timer.start()
            with late.one(due):
                plan(space, start, goal, algorithm=algorithm, cancel=cancel, seed=k)
            timer.join()
        worst[algorithm] = late
    return _summed('time from cancellation to return, p99', worst, 5.0)


def _cancel(cancel: threading.Event, due: list[float]) -> None:
    due.append(time.perf_counter())
    cancel.set()


class _Lateness:
    """
    Delays with which calls returned [s].

    The target holds for an idle core, so calls that had none for longer than ``LOST`` are counted
    apart.
    """

    def __init__(self) -> None:
        self.undisturbed: list[float] = []
        self.disturbed: list[float] = []

    @contextmanager
    def one(self, due: list[float]) -> Iterator[None]:
        """Time the block; by its end ``due`` has the time at which it was due to end."""
        began, worked_before = time.perf_counter(), time.thread_time()
        yield
        ended, worked = time.perf_counter(), time.thread_time() - worked_before
        calls = self.undisturbed if ended - began - worked < LOST else self.disturbed
        calls.append(ended - due[0])

    @property
    def worst(self) -> float:
        """The 99th percentile [ms] of the calls that had their core; of all where none did."""
        return 1e3 * float(np.quantile(self.undisturbed or self.disturbed, 0.99))

    @property
    def worst_of_all(self) -> float:
        """The 99th percentile [ms] of all calls."""
        return 1e3 * float(np.quantile(self.undisturbed + self.disturbed, 0.99))


def _summed(what: str, late: dict[str, _Lateness], target: float) -> Verdict:
    words = [
        f'{name} {calls.worst:.2f} ms ({len(calls.undisturbed)} calls; '
        f'{calls.worst_of_all:.1f} with {len(calls.disturbed)} that lost the core)'
        for name, calls in late.items()
    ]
    met = max(calls.worst for calls in late.values()) <= target
    return Verdict(what, f'{target:g} ms', ', '.join(words), met)


def _timed(call: Callable[[], Any]) -> float:
    began = time.perf_counter()
    call()
    return time.perf_counter() - began
