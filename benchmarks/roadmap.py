"""
Many requests on one map: what a roadmap costs to build and mend, and what its answers are worth.

``python -m benchmarks.roadmap [--quick]`` measures it alone. A request is the whole call of
``plan()`` from Python; lengths are ratios over the shortest path known, from long searches and
from a roadmap of twice the draws. A map is mended after a block of twenty cells' side has come up
in a free place, and again when it has gone.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
import time
from typing import NamedTuple, TypeVar

from benchmarks.problems import Floats, Problem, problems
from hnr_planner.core import GridSpace, plan, Roadmap, warm_up
import numpy as np

#: Times that each request is asked; searches for the shortest path known.
REPEATS = 20
SEARCHES, SEARCHES_QUICK = 100, 20
#: Side of the block that comes and goes [cells].
BLOCK = 20
SEED = 0

Result = TypeVar('Result')


class Row(NamedTuple):
    """One map: seconds to build and mend, nodes, seconds of the requests, ratios of lengths."""

    name: str
    build: float
    nodes: int
    requests: Floats
    ratios: Floats
    block_comes: float
    block_goes: float


def measure(problem: Problem, searches: int) -> Row:
    """Build, ask, change the map and mend."""
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


def _timed(work: Callable[[], Result]) -> tuple[Result, float]:
    began = time.perf_counter()
    result = work()
    return result, time.perf_counter() - began


def _with_block(space: GridSpace) -> GridSpace:
    """Return the same map with a block in its largest part."""
    rows, columns = np.nonzero(space.largest_component())
    k = np.random.default_rng(SEED).integers(len(rows))
    top, left = max(rows[k] - BLOCK // 2, 0), max(columns[k] - BLOCK // 2, 0)
    bottom, right = top + BLOCK, left + BLOCK
    blocked = space.blocked.copy()
    blocked[top:bottom, left:right] = True
    return GridSpace.from_blocked(blocked, space.resolution, space.origin)


def table(rows: list[Row]) -> str:
    """Write rows as a table in Markdown."""
    lines = [
        '| problem | nodes | build, s | block comes, s | block goes, s | request, us | p95 '
        '| length | p95 |',
        '| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |',
    ]
    for row in rows:
        median, late = np.quantile(row.requests, (0.5, 0.95)) * 1e6
        typical, long = np.quantile(row.ratios, (0.5, 0.95))
        lines.append(
            f'| {row.name} | {row.nodes} | {row.build:.2f} | {row.block_comes:.2f} '
            f'| {row.block_goes:.2f} | {median:.0f} | {late:.0f} | {typical:.4f} | {long:.4f} |'
        )
    return '\n'.join(lines)


def measure_all(quick: bool) -> list[Row]:
    """Measure all problems, or few of them for a quick look."""
    rows = []
    for problem in problems(quick):
        rows.append(measure(problem, SEARCHES_QUICK if quick else SEARCHES))
        print(table(rows[-1:]).splitlines()[-1], flush=True)
    return rows


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog='python -m benchmarks.roadmap', description=__doc__)
    parser.add_argument('--quick', action='store_true', help='two maps and two spirals')
    quick = parser.parse_args().quick
    warm_up()
    Roadmap.build(GridSpace.from_blocked(np.zeros((3, 3), dtype=bool)), seed=0)
    print(f'\n{table(measure_all(quick))}')


if __name__ == '__main__':
    main()
