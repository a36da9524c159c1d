"""OMPL's planners: setup and solve, timed where they run. In C++, and from PyPI through Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache

from benchmarks import ompl
from benchmarks.competitors.competitor import (
    Competitor,
    Missing,
    Run,
    Solver,
    SolverOf,
    TIME_LIMIT,
)
from benchmarks.problems import Floats, Problem

#: Names of the two builds in the report.
NATIVE, WHEEL = 'OMPL', 'OMPL PyPI'
SIMPLIFY = '+simplify'


def ompl_native() -> list[Competitor]:
    """Return the planners of the C++ library, or raise Missing."""
    session = _session(ompl.native)
    names = ('BKPIECE1', 'KPIECE1', 'RRT', 'EST', 'SBL')
    anytime = {'RRT*': 'RRTstar', 'Informed RRT*': 'InformedRRTstar', 'BIT*': 'BITstar'}
    return [
        Competitor('RRTConnect', NATIVE, 'first', _first(session, 'RRTConnect'), runs_least=20),
        *(Competitor(name, NATIVE, 'first', _first(session, name)) for name in names),
        _simplified(session, NATIVE),
        *(_anytime(session, NATIVE, name, inside) for name, inside in anytime.items()),
    ]


def ompl_wheel() -> list[Competitor]:
    """Return some planners of the wheel from PyPI, or raise Missing."""
    session = _session(ompl.wheel)
    names = ('RRTConnect', 'BKPIECE1')
    return [
        *(Competitor(name, WHEEL, 'first', _first(session, name)) for name in names),
        _simplified(session, WHEEL),
        _anytime(session, WHEEL, 'BIT*', 'BITstar'),
    ]


@cache
def _session(command: Callable[[], list[str]]) -> ompl.Session:
    """Start a program; it serves all problems and ends with this process."""
    try:
        return ompl.Session(command())
    except ompl.MissingOmpl as reason:
        raise Missing(str(reason)) from None


def _first(session: ompl.Session, planner: str) -> SolverOf:
    return _solver(session, planner, TIME_LIMIT)


def _simplified(session: ompl.Session, group: str) -> Competitor:
    solver = _first(session, f'RRTConnect{SIMPLIFY}')
    return Competitor('RRTConnect + simplify', group, 'short', solver)


def _anytime(session: ompl.Session, group: str, name: str, inside: str) -> Competitor:
    return Competitor(
        name, group, 'short', None, lambda seconds: _solver(session, inside, seconds)
    )


def _solver(session: ompl.Session, planner: str, seconds: float) -> SolverOf:
    @contextmanager
    def solver(problem: Problem) -> Iterator[Solver]:
        space, blocked = problem.space, problem.blocked_in_kernel

        def solve(requests: Floats, seed: int) -> list[Run]:
            session.use(blocked)
            answers = session.solve(planner, seconds, list(space.to_kernel(requests)))
            return [Run(answer.seconds, space.from_kernel(answer.path)) for answer in answers]

        yield solve

    return solver
