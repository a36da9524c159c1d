"""Grid search: our implementations of the literature, and nano-astar from PyPI."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
import time
from typing import Any

from benchmarks.competitors.competitor import Competitor, Missing, Run, Solver, SolverOf
from benchmarks.problems import Floats, Problem
from hnr_planner.experiments.grid_search import a_star, pull_string, theta_star, wavefront
import numpy as np

#: Function that finds a path (m, 2) [cells] on a compiled grid.
Search = Callable[[Any, Floats, Floats], Floats]


def grid_searches() -> list[Competitor]:
    """Return the searches that need no further package."""
    searches: dict[str, Search] = {
        'A*': a_star,
        'A* + string pulling': _taut(a_star),
        'Theta*': theta_star,
        'Theta* + string pulling': _taut(theta_star),
        'wavefront': wavefront,
    }
    return [Competitor(name, 'grid', 'short', search_with(of)) for name, of in searches.items()]


def nano_a_star() -> list[Competitor]:
    """Return nano-astar, alone and with our string pulling, or raise Missing."""
    try:
        from nano_astar import astar
    except ImportError as reason:
        raise Missing(f'nano-astar: {reason} (pip install nano-astar)') from None

    @contextmanager
    def plain(problem: Problem) -> Iterator[Solver]:
        blocked = (problem.space.data.free_distance == 0).astype(np.uint8)  # as it wants them

        def search(grid: Any, start: Floats, goal: Floats) -> Floats:
            ends = [(int(y), int(x)) for x, y in (start, goal)]
            cells, _ = astar(blocked, *ends)
            return cells[:, ::-1] + 0.5

        with search_with(search)(problem) as solve:
            yield solve

    @contextmanager
    def pulled(problem: Problem) -> Iterator[Solver]:
        with plain(problem) as solve:
            yield lambda requests, seed: [_pull(problem, run) for run in solve(requests, seed)]

    return [
        Competitor('nano-astar', 'grid', 'short', plain),
        Competitor('nano-astar + string pulling', 'grid', 'short', pulled),
    ]


def _pull(problem: Problem, run: Run) -> Run:
    path = problem.space.to_kernel(run.path)
    began = time.perf_counter()
    path = pull_string(problem.space.data, path)
    seconds = run.seconds + time.perf_counter() - began
    return Run(seconds, problem.space.from_kernel(path))


def _taut(search: Search) -> Search:
    return lambda grid, start, goal: pull_string(grid, search(grid, start, goal))


def search_with(search: Search) -> SolverOf:
    """Return a solver that times a search without the conversion between metres and cells."""

    @contextmanager
    def solver(problem: Problem) -> Iterator[Solver]:
        space = problem.space

        def solve(requests: Floats, seed: int) -> list[Run]:
            runs = []
            for start, goal in space.to_kernel(requests):
                began = time.perf_counter()
                path = search(space.data, start, goal)
                runs.append(Run(time.perf_counter() - began, space.from_kernel(path)))
            return runs

        solve(problem.requests[:1], 0)  # compiles
        yield solve

    return solver
