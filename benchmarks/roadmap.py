"""
Section: roadmaps; what they cost to build and repair, and the quality of their answers.

A request is the whole call of ``plan()`` from Python; lengths are ratios over the shortest path
known, from long searches and from a roadmap of twice the draws. A roadmap is repaired after a
block of 20 x 20 cells has been put into free space, and again after it has been removed.
"""

from __future__ import annotations

from collections.abc import Callable
import time
from typing import NamedTuple, TypeVar

from benchmarks.problems import Floats, Problem
from benchmarks.progress import show
from benchmarks.sections import Bench, on_all, Section, table
from hnr_planner.core import GridSpace, plan, Roadmap
import numpy as np

#: Repetitions of each request; searches for the shortest path known.
REPEATS = 20
SEARCHES, SEARCHES_QUICK = 100, 20
#: Side of the block that is put in and removed [cells].
BLOCK = 20
SEED = 0
#: Targets: median time of a request [s], and median length over the best known.
REQUEST, LENGTH = 0.1e-3, 1.01

Result = TypeVar('Result')


class Row(NamedTuple):
    """Results on one map: times [s] to build, repair and answer, nodes, ratios of lengths."""

    name: str
    build: float
    nodes: int
    requests: Floats
    ratios: Floats
    block_comes: float
    block_goes: float


def measure(problem: Problem, searches: int) -> Row:
    """Build a roadmap, answer requests, change the map and repair the roadmap."""
    space = problem.space
    roadmap, build = _timed(lambda: Roadmap.build(space, seed=SEED))
    grown = roadmap.grow()
    seconds, ratios = [], []
    for start, goal in problem.requests:
        answers = [
            _timed(lambda: plan(space, start, goal, algorithm=roadmap, seed=SEED))  # noqa: B023
            for _ in range(REPEATS)
        ]
        known = [
            plan(space, start, goal, algorithm=grown, seed=SEED),
            plan(space, start, goal, seed=SEED, optimize_iterations=searches, time_limit=60.0),
        ]
        length = answers[0][0].length
        seconds += [answer[1] for answer in answers]
        ratios.append(length / min(length, *(path.length for path in known)))
    changed = _with_block(space)
    mended, comes = _timed(lambda: roadmap.update(changed))
    _, goes = _timed(lambda: mended.update(space))
    return Row(
        problem.name,
        build,
        len(roadmap.nodes),
        np.array(seconds),
        np.array(ratios),
        comes,
        goes,
    )


def roadmap(bench: Bench) -> Section:
    """Measure a roadmap on every problem."""
    Roadmap.build(GridSpace.from_blocked(np.zeros((3, 3), dtype=bool)), seed=0)
    rows = []
    for problem in bench.problems:
        rows.append(measure(problem, SEARCHES_QUICK if bench.quick else SEARCHES))
        show(f'roadmap of {problem.name}: built in {rows[-1].build:.1f} s')
    slow = {
        row.name: f'{1e6 * np.median(row.requests):.0f} us'
        for row in rows
        if np.median(row.requests) > REQUEST
    }
    long = {
        row.name: f'{np.median(row.ratios):.3f}' for row in rows if np.median(row.ratios) > LENGTH
    }
    verdicts = [
        on_all('a request with a roadmap, median', f'{1e6 * REQUEST:.0f} us', slow, len(rows)),
        on_all('its length over the best known, median', f'{LENGTH:g}', long, len(rows)),
    ]
    head = (
        'problem | nodes | build, s | block comes, s | block goes, s | request, us | p95 | length '
        '| p95'
    )
    return Section('Many requests on one map', table(head, map(_row, rows)), verdicts)


def _timed(work: Callable[[], Result]) -> tuple[Result, float]:
    began = time.perf_counter()
    result = work()
    return result, time.perf_counter() - began


def _with_block(space: GridSpace) -> GridSpace:
    """Return the same map with a block in its largest component."""
    rows, columns = np.nonzero(space.largest_component())
    k = np.random.default_rng(SEED).integers(len(rows))
    top, left = max(rows[k] - BLOCK // 2, 0), max(columns[k] - BLOCK // 2, 0)
    bottom, right = top + BLOCK, left + BLOCK
    blocked = space.blocked.copy()
    blocked[top:bottom, left:right] = True
    return GridSpace.from_blocked(blocked, space.resolution, space.origin)


def _row(row: Row) -> list[str]:
    median, late = np.quantile(row.requests, (0.5, 0.95)) * 1e6
    typical, long = np.quantile(row.ratios, (0.5, 0.95))
    seconds = (row.build, row.block_comes, row.block_goes)
    return [
        row.name,
        f'{row.nodes}',
        *(f'{value:.2f}' for value in seconds),
        *(f'{value:.0f}' for value in (median, late)),
        *(f'{value:.4f}' for value in (typical, long)),
    ]
