"""Ours: the whole call of ``plan()`` from Python."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from statistics import median
import time
from typing import Any

from benchmarks.competitors.competitor import Competitor, Run, Solver, SolverOf, TIME_LIMIT
from benchmarks.competitors.grid import search_with
from benchmarks.problems import Floats, Problem
from hnr_planner.core import plan
from hnr_planner.experiments.grid_search import wavefront
import numpy as np

#: Least time to optimize in [s], where a wavefront is faster than that.
LEAST_TIME = 1e-3
#: Runs by which the time of a wavefront is measured, and the fraction of that time to use.
CALIBRATION, USED = 40, 0.9


def ours() -> list[Competitor]:
    """Return our planners."""
    first = [
        Competitor(name, 'ours', 'first', _plan(algorithm=name, simplify=False), runs_least=least)
        for name, least in (('auto', 200), ('hit_and_run', 3), ('rrt', 3), ('rrt_connect', 3))
    ]
    return [
        *first,
        Competitor('auto + simplify', 'ours', 'short', _plan(algorithm='auto'), runs_least=100),
        Competitor('polyanya', 'ours', 'short', _plan(algorithm='polyanya'), runs_least=100),
        Competitor('auto, optimized', 'ours', 'short', _optimized, _optimized_for, runs_least=100),
    ]


def _plan(**settings: Any) -> SolverOf:
    @contextmanager
    def solver(problem: Problem) -> Iterator[Solver]:
        def solve(requests: Floats, seed: int) -> list[Run]:
            runs = []
            for k, (start, goal) in enumerate(requests):
                began = time.perf_counter()
                result = plan(
                    problem.space, start, goal, time_limit=TIME_LIMIT, seed=seed + k, **settings
                )
                runs.append(Run(time.perf_counter() - began, result.path))
            return runs

        yield solve

    return solver


def _optimized_for(seconds: float) -> SolverOf:
    return _plan(algorithm='auto', optimize_for=seconds)


@contextmanager
def _optimized(problem: Problem) -> Iterator[Solver]:
    """Look for a shorter path for as long as a wavefront takes."""
    with search_with(wavefront)(problem) as waves:
        requests = np.resize(problem.requests, (CALIBRATION, 2, 2))
        allowed = median(run.seconds for run in waves(requests, 0))
    with _optimized_for(USED * max(allowed, LEAST_TIME))(problem) as solve:
        yield solve
