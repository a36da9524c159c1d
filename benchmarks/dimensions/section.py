"""Measure planning in n dimensions beside OMPL in C++, and write the section of the report."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import closing
from itertools import islice
import math
import time
from typing import NamedTuple

from benchmarks.dimensions.courses import Instance, instances, PROBLEMS
from benchmarks.dimensions.unions import many_boxes
from benchmarks.ompl.dimensions import DimensionsSession
from benchmarks.ompl.driver import MissingOmpl
from benchmarks.pinned import on_one_core
from benchmarks.problems import Floats
from benchmarks.progress import show
from benchmarks.sections import Bench, milliseconds, on_all, ratio, Section, table
from benchmarks.standings import quantile
from hnr_planner.core import plan, Space
import numpy as np

#: Planners that take part, the first of ours for the verdict.
OURS = ('auto', 'rrt_connect')
OMPL = ('RRTConnect', 'BiEST', 'BKPIECE1', 'LBKPIECE1', 'SBL')
#: Least seed of the instances here: the planners were tuned on those with smaller seeds.
HELD_OUT = 1000
#: Instances of each problem, and runs of each competitor in a row, the first not for the record.
INSTANCES, INSTANCES_QUICK, RUNS = 20, 4, 6
#: Time limit of a request [s].
LIMIT = 1.0
#: Target: our length after shortening over OMPL's.
LONGER = 1.02

EXPLAINED = """\
Everybody gets obstacles and requests that ours was not tuned on, and runs in a row. Times are
processor time of the first path, medians and 95th percentiles in milliseconds: for ours the whole
call of `plan()` from Python, for OMPL `setup()` and `solve()`. Validity is C++ for OMPL and numba
for ours. Solids are tested exactly by both; the arm, known by membership alone, at every .05 rad.
Every path is judged by points along it, and one that is not free counts as none. The hole of .3 is
narrow in all coordinates of the wall, that of .1 in two of them. *Shortened* is the median length
after shortening: of ours, of OMPL after `simplifyMax`, and of OMPL where its simplifier goes on
for as long as a call of ours takes in the median."""


class Run(NamedTuple):
    """Processor time [s] and length of the path; inf where there is none."""

    seconds: float
    length: float


#: Function of the number of a run that returns processor time [s] and path (m, dim).
Runner = Callable[[int], tuple[float, Floats]]


class Row(NamedTuple):
    """Runs on all instances of a problem: first paths and shortened ones, by competitor."""

    name: str
    first: dict[str, list[Run]]
    shortened: dict[str, list[Run]]

    def seconds(self, who: str, part: float = 0.5) -> float:
        """Return a quantile of the time to a first path [s]."""
        return quantile(np.array([run.seconds for run in self.first[who]]), part)

    def length(self, who: str) -> float:
        """Return the median length after shortening."""
        return quantile(np.array([run.length for run in self.shortened[who]]), 0.5)

    @property
    def fastest(self) -> str:
        """Name of the fastest of OMPL's planners."""
        return min(OMPL, key=self.seconds)

    @property
    def shortest(self) -> str:
        """Name of the one of OMPL's competitors whose paths are the shortest."""
        return min((name for name in self.shortened if name not in OURS), key=self.length)


def dimensions(bench: Bench) -> Section:
    """Compare first and shortened paths in n dimensions, and walks in large unions."""
    title = 'In n dimensions'
    unions, verdicts = many_boxes()
    try:
        session = DimensionsSession()
    except MissingOmpl as reason:
        return Section(title, f'**Missing.** {reason}\n\n{unions}', verdicts)
    with closing(session), on_one_core():
        n = INSTANCES_QUICK if bench.quick else INSTANCES
        rows = [measure(name, session, n, HELD_OUT) for name in PROBLEMS]
    ours = OURS[0]
    slow = {
        row.name: f'{row.seconds(ours) / row.seconds(row.fastest):.2f} x'
        for row in rows
        if not row.seconds(ours) <= row.seconds(row.fastest)
    }
    long = {
        row.name: f'{row.length(ours) / row.length(row.shortest):.3f}'
        for row in rows
        if not row.length(ours) <= LONGER * row.length(row.shortest)
    }
    verdicts = [
        on_all('first path in n dimensions, median', "OMPL's fastest there", slow, len(rows)),
        on_all('length in n dimensions, shortened', f"{LONGER:g} of OMPL's", long, len(rows)),
        *verdicts,
    ]
    body = [EXPLAINED, first_paths(rows), shortened_paths(rows), unions]
    return Section(title, '\n\n'.join(body), verdicts)


def measure(name: str, session: DimensionsSession, n_instances: int, first_seed: int) -> Row:
    """Return the runs of everybody on instances of a problem, in turns."""
    row = Row(name, defaultdict(list), defaultdict(list))
    for instance in islice(instances(name, first_seed), n_instances):
        show(f'in n dimensions, {name}')
        session.enter(instance.course.words())
        space = instance.course.space()
        for who in OURS:
            row.first[who] += _in_a_row(instance, _ours(space, instance, who, simplify=False))
        for who in OMPL:
            row.first[who] += _in_a_row(instance, _ompl(session, instance, who))
        for who in OURS:
            row.shortened[who] += _in_a_row(instance, _ours(space, instance, who, simplify=True))
        for who in OMPL:
            row.shortened[who] += _in_a_row(instance, _ompl(session, instance, f'{who}+simplify'))
        as_long = quantile(np.array([run.seconds for run in row.shortened[OURS[0]]]), 0.5)
        if as_long < LIMIT:
            again = _ompl(session, instance, f'{OMPL[0]}+shorten', as_long)
            row.shortened[f'{OMPL[0]}, as long'] += _in_a_row(instance, again)
    return row


def _ours(space: Space, instance: Instance, algorithm: str, simplify: bool) -> Runner:
    """Return the runs of a planner of ours."""

    def run(k: int) -> tuple[float, Floats]:
        began = time.process_time()
        result = plan(space, *instance.request, algorithm=algorithm, seed=k, simplify=simplify)
        return time.process_time() - began, result.path

    return run


def _ompl(
    session: DimensionsSession, instance: Instance, planner: str, limit: float = LIMIT
) -> Runner:
    """Return the runs of a planner of OMPL."""
    return lambda _: session.plan(planner, limit, instance.request)


def _in_a_row(instance: Instance, run: Runner) -> list[Run]:
    """
    Return the runs of a competitor, all but the first.

    They are judged at the end: to judge a path empties the caches that the next run needs.
    """
    return [_judged(instance, *done) for done in [run(k) for k in range(RUNS)][1:]]


def _judged(instance: Instance, seconds: float, path: Floats) -> Run:
    """Return the time and length of a run; inf where its path is not one for the request."""
    if len(path) < 2 or (path[[0, -1]] != instance.request).any():
        return Run(math.inf, math.inf)
    if not instance.course.is_path_free(path):
        return Run(math.inf, math.inf)
    return Run(seconds, float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()))


def first_paths(rows: list[Row]) -> str:
    """Return the table of first paths."""
    names = [*OURS, *OMPL]

    def lines() -> Iterator[list[str]]:
        for row in rows:
            times = [
                f'{milliseconds(row.seconds(who))} / {milliseconds(row.seconds(who, 0.95))}'
                for who in names
            ]
            yield [row.name, *times, ratio(row.seconds(OURS[0]) / row.seconds(row.fastest))]

    return table(
        ' | '.join(['first path [ms]', *names, f"{OURS[0]} over OMPL's fastest"]), lines()
    )


def shortened_paths(rows: list[Row]) -> str:
    """Return the table of shortened paths: times, and lengths."""
    others = f'{OMPL[0]}, as long'
    head = f"shortened | {OURS[0]} [ms] | length | OMPL's shortest | length | {others} | ratio"
    return table(
        head,
        (
            [
                row.name,
                milliseconds(float(np.median([run.seconds for run in row.shortened[OURS[0]]]))),
                f'{row.length(OURS[0]):.3f}',
                row.shortest,
                f'{row.length(row.shortest):.3f}',
                f'{row.length(others):.3f}',
                ratio(row.length(OURS[0]) / row.length(row.shortest)),
            ]
            for row in rows
        ),
    )
