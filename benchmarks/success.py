"""Section: whether ``auto`` ever fails; many seeds for each of many pairs, on every problem."""

from __future__ import annotations

import time
from typing import NamedTuple

from benchmarks.competitors import Run, TIME_LIMIT
from benchmarks.judge import Judge
from benchmarks.problems import PAIRS, Problem
from benchmarks.progress import show
from benchmarks.sections import Bench, milliseconds, on_all, Section, table
from hnr_planner.core import plan
from hnr_planner.experiments.requests import far_pairs
import numpy as np

#: Seeds for each pair.
SEEDS = 50


class Successes(NamedTuple):
    """Runs on one problem, those with a valid path in time, and the slowest time [s]."""

    problem: str
    runs: int
    in_time: int
    slowest: float


def success(bench: Bench) -> Section:
    """Count the runs that end with a valid path within the time limit."""
    rows = [_count(problem, 5 if bench.quick else SEEDS) for problem in bench.problems]
    verdict = on_all(
        f'success of `auto` within {TIME_LIMIT:g} s, {rows[0].runs} runs on each problem',
        'no failure',
        {row.problem: f'{row.runs - row.in_time}' for row in rows if row.in_time < row.runs},
        len(rows),
    )
    body = table(
        'problem | runs | with a valid path in time | slowest',
        (
            [row.problem, str(row.runs), str(row.in_time), milliseconds(row.slowest)]
            for row in rows
        ),
    )
    return Section('Success', body, [verdict])


def _count(problem: Problem, seeds: int) -> Successes:
    """Run every pair with every seed; on a spiral the pairs are drawn as on the maps."""
    if problem.is_spiral:
        problem = problem.with_requests(far_pairs(problem.space, PAIRS, seed=0))
    judge, in_time, slowest = Judge(problem), 0, 0.0
    for number, (start, goal) in enumerate(problem.requests):
        show(f'{problem.name}: success for pair {number + 1} of {len(problem.requests)}')
        for seed in range(seeds):
            began = time.perf_counter()
            result = plan(
                problem.space, start, goal, simplify=False, time_limit=TIME_LIMIT, seed=seed
            )
            seconds = time.perf_counter() - began
            slowest = max(slowest, seconds)
            record = judge.judge(number, Run(seconds, result.path))
            in_time += np.isfinite(record.length) and seconds <= TIME_LIMIT
    return Successes(problem.name, len(problem.requests) * seeds, int(in_time), slowest)
