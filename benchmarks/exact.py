"""
Section: the shortest path with its proof, beside others, and the requests of a batch.

Times are those of the processor, so that other processes count less; ``plan`` is the whole call
from Python. Requests are between random free cells of one component, and the far ones of all
problems.
"""

from __future__ import annotations

from collections.abc import Callable
import time
from typing import NamedTuple, TypeVar

from benchmarks.competitors.ompl_planners import NATIVE
from benchmarks.exact_answers import (
    answers_table,
    answers_verdicts,
    default_answers,
    MAPS,
    noisy_answers,
)
from benchmarks.made_maps import maze
from benchmarks.problems import Floats, Problem
from benchmarks.progress import show
from benchmarks.race import Standing
from benchmarks.sections import Bench, milliseconds, on_all, ratio, Section, table, Verdict
from benchmarks.standings import summary
from hnr_planner.core import GridSpace, plan, plan_many, PlanResult
from hnr_planner.core.spaces.grid.slabs import build_slabs
import numpy as np

#: Random requests on each map by ``plan``, and in one batch.
REQUESTS, REQUESTS_QUICK, BATCH = 400, 100, 4000
#: Repetitions of each request and of each mesh: the fastest counts.
REPEATS = 3
SEED = 7
#: Targets: median and p95 of a request [s], where nothing is said of the map and in mazes; mesh
#: [s] and [MB]; requests of a batch for each second of a core.
MEDIAN, P95, IN_MAZES, MESH, MEGABYTES, RATE = 0.5e-3, 3e-3, 2.5e-3, 5e-3, 3.0, 10_000
#: Target: geometric mean of our time over that of RRTConnect's first path.
OVER_RIVAL = 0.8
#: Grid-based path planning competition of 2023, classic any-angle track: means [s] for a request
#: on its machine, with paths of 1,002 cells in the mean.
PUBLISHED = (('Polyanya', 1.47e-3), ('RayScan', 2.59e-3))
#: Chambers along a side of the larger maze, 1000 cells; its requests are random.
LARGE_MAZE, NO_ENDS = 50, np.empty((0, 2, 2))
#: Who stands beside ours on the far requests.
RIVAL = f'RRTConnect ({NATIVE})'
BESIDE = ('polyanya (ours)', 'Theta* (grid)', 'wavefront (grid)', RIVAL)

Result = TypeVar('Result')


class Row(NamedTuple):
    """Results on one problem: times [s] of requests, mesh [s] and [MB], and rate of a batch."""

    name: str
    requests: Floats
    mesh: float
    megabytes: float
    rate: float
    n_proved: int


def exact(bench: Bench) -> Section:
    """Measure ``polyanya`` and ``plan_many`` on every map, and compare with the others."""
    courses = [problem for problem in bench.problems if not problem.is_spiral]
    if not bench.quick:
        grid = maze(LARGE_MAZE)
        courses.append(Problem('maze, large', GridSpace.from_blocked(grid.data >= 65), NO_ENDS))
    rows, answers = [], []
    n_requests = REQUESTS_QUICK if bench.quick else REQUESTS
    for problem in courses:
        show(f'exact: {problem.name}')
        rows.append(_measure(problem, n_requests))
        if problem.name in MAPS:
            ends = _random_ends(problem.space, n_requests)
            answers.append(default_answers(problem.name, problem.space, ends))
    if not bench.quick:
        answers.append(noisy_answers(_random_ends))
    body = '\n\n'.join(
        [
            table(
                'random requests | median | p95 | most | proved | mesh | MB | batch, 1/s',
                map(_cells, rows),
            ),
            'The grid-based path planning competition of 2023, classic any-angle track, has '
            'published means for a request on its machine, with paths of 1,002 cells in the mean: '
            + ', '.join(f'{name} {milliseconds(mean)} ms' for name, mean in PUBLISHED)
            + '. The last column of the next table has the mean length of the far paths here.',
            table(
                'far requests | polyanya | Theta\\* | wavefront | RRTConnect | cells',
                [_beside(standing) for standing in bench.standings],
            ),
            answers_table(answers),
        ]
    )
    verdicts = _verdicts(rows, bench.standings) + answers_verdicts(answers)
    return Section('The shortest path, proved', body, verdicts)


def _measure(problem: Problem, n_requests: int) -> Row:
    space, ends = problem.space, _random_ends(problem.space, BATCH)
    free_distance = space.data.free_distance
    mesh = min(_seconds(lambda: build_slabs(free_distance))[1] for _ in range(REPEATS))
    megabytes = sum(np.asarray(array).nbytes for array in space.slabs) / 1e6
    results, times = [], []
    for start, goal in ends[:n_requests]:
        runs = [_request(space, start, goal) for _ in range(REPEATS)]
        results.append(runs[0][0])
        times.append(min(seconds for _, seconds in runs))
    starts, goals = ends[:, 0], ends[:, 1]
    batch = min(_seconds(lambda: plan_many(space, starts, goals, n_jobs=1))[1] for _ in range(2))
    proved = sum(result.length <= (1.0 + 1e-6) * result.lower_bound for result in results)
    return Row(problem.name, np.array(times), mesh, megabytes, len(ends) / batch, proved)


def _request(space: GridSpace, start: Floats, goal: Floats) -> tuple[PlanResult, float]:
    return _seconds(lambda: plan(space, start, goal, algorithm='polyanya', time_limit=60.0))


def _seconds(work: Callable[[], Result]) -> tuple[Result, float]:
    began = time.process_time()
    result = work()
    return result, time.process_time() - began


def _random_ends(space: GridSpace, n: int) -> Floats:
    """Return starts and goals (n, 2, 2) [m]: centres of cells of the largest component."""
    cells = np.argwhere(space.largest_component())
    rows = np.random.default_rng(SEED).integers(len(cells), size=2 * n)
    return space.cell_centres(*cells[rows].T).reshape(n, 2, 2)


def _cells(row: Row) -> list[str]:
    return [
        row.name,
        milliseconds(float(np.median(row.requests))),
        milliseconds(float(np.quantile(row.requests, 0.95))),
        milliseconds(float(row.requests.max())),
        f'{row.n_proved} of {len(row.requests)}',
        milliseconds(row.mesh),
        f'{row.megabytes:.2f}',
        f'{row.rate:,.0f}',
    ]


def _beside(standing: Standing) -> list[str]:
    """Return the medians of the others on the far requests of a problem, and our mean length."""
    cells = float(np.mean(standing.best)) / standing.problem.space.resolution
    times = _medians(standing)
    return [
        standing.problem.name,
        *(milliseconds(times.get(label, np.nan)) for label in BESIDE),
        f'{cells:,.0f}',
    ]


def _medians(standing: Standing) -> dict[str, float]:
    """Return the median time [s] of each of ``BESIDE`` that has run on a problem."""
    return {
        entry.competitor.label: summary(entry, standing).seconds
        for entry in standing.entries
        if entry.competitor.label in BESIDE
    }


def _verdicts(rows: list[Row], standings: list[Standing]) -> list[Verdict]:
    mazes = [row for row in rows if row.name.startswith('maze')]
    plain = [row for row in rows if not row.name.startswith('maze')]
    slow = {r.name: milliseconds(m) for r in plain if (m := float(np.median(r.requests))) > MEDIAN}
    late = {
        r.name: milliseconds(p) for r in plain if (p := float(np.quantile(r.requests, 0.95))) > P95
    }
    winding = {
        r.name: milliseconds(m) for r in mazes if (m := float(np.median(r.requests))) > IN_MAZES
    }
    large = {
        r.name: f'{milliseconds(r.mesh)} ms, {r.megabytes:.2f} MB'
        for r in rows
        if r.mesh > MESH or r.megabytes > MEGABYTES
    }
    unproved = {r.name: str(r.n_proved) for r in rows if r.n_proved < len(r.requests)}
    office = [row.rate for row in rows if row.name == 'office']
    return [
        on_all('random requests by `polyanya` [ms], median', '.5', slow, len(plain)),
        on_all('random requests by `polyanya` [ms], p95', '3', late, len(plain)),
        on_all('random requests in mazes [ms], median', '2.5', winding, len(mazes)),
        on_all('mesh', '5 ms, 3 MB', large, len(rows)),
        on_all('paths of `polyanya` proved to be the shortest', 'all', unproved, len(rows)),
        *(
            Verdict(
                'requests of a batch on the office map, for each core and second',
                f'{RATE:,}',
                f'{rate:,.0f}',
                rate >= RATE,
            )
            for rate in office
        ),
        *_against_ompl(standings),
    ]


def _against_ompl(standings: list[Standing]) -> list[Verdict]:
    """Return the verdict on the geometric mean over the maps, where OMPL in C++ has run."""
    ratios = []
    for standing in standings:
        times = _medians(standing)
        if not standing.problem.is_spiral and RIVAL in times:
            ratios.append(times['polyanya (ours)'] / times[RIVAL])
    if not ratios:
        return []
    mean = float(np.exp(np.mean(np.log(ratios))))
    what = "`polyanya` over RRTConnect's first path, far requests, geometric mean over the maps"
    return [Verdict(what, f'{OVER_RIVAL:g}', ratio(mean), mean <= OVER_RIVAL)]
