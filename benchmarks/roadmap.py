"""
Section: roadmaps; what they cost to build and repair, and the quality of their answers.

A request is the whole call of ``plan()`` from Python; in a batch it is a share of a call of
``Roadmap.distances``. Lengths are ratios over the lower bound of Polyanya. A roadmap is repaired
after a block of 20 x 20 cells has been put into free space, and again after it has been removed.
"""

from __future__ import annotations

from collections.abc import Callable
import math
import time
from typing import NamedTuple, TypeVar

from benchmarks.problems import Floats, Problem
from benchmarks.progress import show
from benchmarks.sections import Bench, milliseconds, on_all, Section, table, Verdict
from hnr_planner.core import GridSpace, plan, Polyanya, Roadmap
import numpy as np

#: Repetitions of each request, of each batch, and of building and repairing.
REPEATS = 20
#: Random requests in a batch.
BATCH = 1000
#: Side of the block that is put in and removed [cells].
BLOCK = 20
SEED = 0
#: Targets: time to build [s] on maps of buildings, median time of a request and time of a request
#: in a batch on these maps [s], and length over the lower bound.
BUILD, REQUEST, IN_BATCH, LENGTH = 50e-3, 0.1e-3, 25e-6, 1.0 + 1e-6
BUILDINGS = ('office', 'depot')

Result = TypeVar('Result')


class Row(NamedTuple):
    """Results on one map: times [s] to build, repair and answer, memory, ratios of lengths."""

    name: str
    build: float
    nodes: int
    megabytes: float
    requests: Floats
    in_batch: float
    ratios: Floats
    block_comes: float
    block_goes: float


def measure(problem: Problem) -> Row:
    """Build a roadmap, answer requests, change the map and repair the roadmap."""
    space = problem.space
    roadmap, build = _fastest(lambda: Roadmap.build(space, seed=SEED))
    seconds, ratios = [], []
    for start, goal in problem.requests:
        answers = [
            _timed(lambda: plan(space, start, goal, algorithm=roadmap, seed=SEED))  # noqa: B023
            for _ in range(REPEATS)
        ]
        shortest = plan(space, start, goal, algorithm=Polyanya(), time_limit=math.inf)
        seconds += [answer[1] for answer in answers]
        ratios.append(answers[0][0].length / shortest.lower_bound)
    starts, goals = _random_ends(space)
    _, batch = _fastest(lambda: roadmap.distances(starts, goals))
    changed = _with_block(space)
    repaired, comes = _fastest(lambda: roadmap.update(changed))
    _, goes = _fastest(lambda: repaired.update(space))
    return Row(
        problem.name,
        build,
        len(roadmap.nodes),
        roadmap.nbytes / 1e6,
        np.array(seconds),
        batch / BATCH,
        np.array(ratios),
        comes,
        goes,
    )


def roadmap(bench: Bench) -> Section:
    """Measure a roadmap on every problem."""
    warm = Roadmap.build(GridSpace.from_blocked(np.zeros((3, 3), dtype=bool)), seed=0)
    warm.distances([(0.5, 0.5)], [(2.5, 2.5)])
    rows = []
    for problem in bench.problems:
        rows.append(measure(problem))
        show(f'roadmap of {problem.name}: built in {milliseconds(rows[-1].build)} ms')
    buildings = [row for row in rows if row.name in BUILDINGS]
    verdicts = [
        _at_most('a request with a roadmap, median', REQUEST, rows, lambda r: r.requests),
        _at_most('a roadmap of a building', BUILD, buildings, lambda r: r.build),
        _at_most('a request in a batch there', IN_BATCH, buildings, lambda r: r.in_batch),
        on_all(
            'its length over the lower bound',
            f'{LENGTH:.7g}',
            {row.name: f'{row.ratios.max():.7f}' for row in rows if row.ratios.max() > LENGTH},
            len(rows),
        ),
    ]
    head = (
        'problem | nodes | MB | build, ms | block comes, ms | block goes, ms | request, us | p95 '
        '| in a batch, us | length, max'
    )
    return Section('Many requests on one map', table(head, map(_row, rows)), verdicts)


def _at_most(
    what: str, target: float, rows: list[Row], seconds: Callable[[Row], float | Floats]
) -> Verdict:
    """Return the verdict on the median of times [s], which has a target on all rows."""
    medians = {row.name: float(np.median(seconds(row))) for row in rows}
    slow = {name: f'{milliseconds(time)} ms' for name, time in medians.items() if time > target}
    return on_all(what, f'{milliseconds(target)} ms', slow, len(rows))


def _random_ends(space: GridSpace) -> tuple[Floats, Floats]:
    """Return random starts and goals (BATCH, 2) in cells of the largest component."""
    cells = np.argwhere(space.largest_component())
    chosen = cells[np.random.default_rng(SEED).integers(len(cells), size=(2, BATCH))]
    starts, goals = (space.cell_centres(*ends.T) for ends in chosen)
    return starts, goals


def _fastest(work: Callable[[], Result]) -> tuple[Result, float]:
    """Return a result, and the least time [s] of ``REPEATS`` calls."""
    results = [_timed(work) for _ in range(REPEATS)]
    return results[0][0], min(seconds for _, seconds in results)


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
    return [
        row.name,
        f'{row.nodes}',
        f'{row.megabytes:.2f}',
        *map(milliseconds, (row.build, row.block_comes, row.block_goes)),
        *(f'{value:.0f}' for value in (median, late, 1e6 * row.in_batch)),
        f'{row.ratios.max():.7f}',
    ]
