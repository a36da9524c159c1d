"""Section: robots that are not round, against OMPL's planners for Reeds and Shepp's car."""

from __future__ import annotations

from contextlib import closing
import math
from test.pose_checker import PoseChecker
import time
from typing import NamedTuple

from benchmarks.ompl.driver import MissingOmpl
from benchmarks.ompl.poses import PoseSession, STEP
from benchmarks.pinned import on_one_core
from benchmarks.pose_courses import pose_courses, PoseCourse, RADIUS
from benchmarks.progress import say, show
from benchmarks.sections import Bench, milliseconds, ratio, Section, table, Verdict
from hnr_planner.core import plan, PlannerStatus, PoseSpace
from hnr_planner.core.spaces.poses.drive import CAR
import numpy as np
from numpy.typing import NDArray

#: Planners of OMPL that take part.
OMPL = ('RRTConnect', 'BKPIECE1')
#: Time limit of a request [s].
LIMIT = 5.0
#: Random pairs on each map, and runs of a request on the other courses; with OMPL, which needs
#: its limit often, fewer.
PAIRS, RUNS, PAIRS_OMPL = 100, 6, 20
PAIRS_QUICK, RUNS_QUICK = 6, 2
#: Paths of each course that the independent checker follows in small steps, and the size of
#: those [cells].
CHECKED, CHECK_STEP = 10, 0.2
#: Targets: our median over that of OMPL's best on two maps.
SHARE = {'office': 0.1, 'depot': 0.5}

EXPLAINED = f"""\
A robot of .9 m by .6 m; the car's turning radius is {RADIUS:g} m. Pairs of poses are random, at
least 5 m apart (2.5 m on tb3_sandbox, which is 4.5 m wide) and joined by the largest disc in the
footprint; none was used to choose a setting. *First* is the time to a path as it is found,
*shortened* the time of a whole request: medians in milliseconds of the processor. Length is over
that of the disc's shortest path, which no robot can be below by more than its size. Our paths are
exact all along; a sample of them is followed in steps of {CHECK_STEP:g} cell by an independent
checker. OMPL 1.5 tests its states exactly, and motions at steps of {STEP:g} m only: what its paths
touch in between is not counted here. All find a path within {LIMIT:g} s, or fail.

Nav2's Smac Hybrid-A* (C++, jazzy 1.3.13, a real planner server, on the same office and depot but
other pairs and another machine load, as measured for this project on 2026-11-29) needs 116 ms
(median; 95 %: 374) and 19 ms (112), with paths of 1.08 of the disc's shortest; it tests the cost
of the robot's centre, or its footprint at poses."""


class Run(NamedTuple):
    """Times to the first and to the shortened path [s], its length over the disc's, reversals."""

    first: float
    whole: float
    length: float
    reversals: int


class Row(NamedTuple):
    """Runs of ours on one course with one drive, times of OMPL's planners, faults of our paths."""

    name: str
    drive: str
    ours: list[Run]
    ompl: dict[str, list[float]]
    faults: list[str]

    @property
    def success(self) -> float:
        """Fraction of our runs that found a path."""
        return float(np.mean([run.length < math.inf for run in self.ours]))

    @property
    def first(self) -> float:
        """Median time to our first path [s]."""
        return float(np.median([run.first for run in self.ours]))

    def over_best(self) -> float:
        """Return our median time to a first path over that of OMPL's best."""
        return self.first / min(float(np.median(seconds)) for seconds in self.ompl.values())


def poses(bench: Bench) -> Section:
    """Compare on maps, doors, bays and slots."""
    title = 'Robots that are not round'
    courses = pose_courses(bench.problems, PAIRS_QUICK if bench.quick else PAIRS)
    try:
        session = PoseSession()
    except MissingOmpl as reason:
        return Section(title, f'**Missing.** {reason}')
    with closing(session), on_one_core():
        rows = [
            _measure(course, drive, session, bench.quick)
            for course in courses
            for drive in ('car', 'differential')
        ]
    head = ' | '.join(
        [
            'course | drive | found | first | 95 % | shortened | length | reversals',
            *(f'{name}, first | found' for name in OMPL),
        ]
    )
    body = f'{EXPLAINED}\n\n{table(head, map(_words, rows))}'
    return Section(title, body, _verdicts(rows))


def _measure(course: PoseCourse, drive: str, session: PoseSession, quick: bool) -> Row:
    """Return the runs on one course: ours, then those of OMPL."""
    space, n = course.space(drive), len(course.requests)
    runs = n if n > 1 else (RUNS_QUICK if quick else RUNS)
    checker = PoseChecker(
        course.grid.uninflated, course.grid.resolution, course.grid.origin, space.footprint
    )
    row = Row(course.name, drive, [], {}, [])
    if space.data.drive == CAR:
        session.use_space(space)
        row.ompl.update({name: [] for name in OMPL})
    show(f'{course.name}, {drive}')
    requests = [course.requests[k % n] for k in range(runs)]
    _first_path(space, requests[0], 0)  # for the caches, not for the record
    # In a row: what else is done for a request would empty the caches.
    firsts = [_first_path(space, ends, k) for k, ends in enumerate(requests)]
    for k, ends in enumerate(requests):
        show(f'{course.name}, {drive}: run {k + 1} of {runs}')
        run, path, twists = _shortened(space, ends, k, firsts[k])
        row.ours.append(run)
        if k < CHECKED and len(path):
            row.faults.extend(checker.collisions(path, twists, CHECK_STEP))
    for name, seconds in row.ompl.items():
        for ends in requests[:PAIRS_OMPL]:
            answer = session.drive(name, LIMIT, space, ends)
            seconds.append(answer.seconds if answer.length < math.inf else math.inf)
    say(f'{course.name}, {drive}: {milliseconds(row.first)} ms, faults {row.faults[:1]}')
    return row


def _first_path(space: PoseSpace, ends: NDArray[np.float64], seed: int) -> float:
    """Return the time to a path as it is found [s]; inf where none is found."""
    began = time.process_time()
    result = plan(space, *ends, seed=seed, simplify=False, time_limit=LIMIT)
    seconds = time.process_time() - began
    return seconds if result.status is PlannerStatus.SOLVED else math.inf


def _shortened(
    space: PoseSpace, ends: NDArray[np.float64], seed: int, first: float
) -> tuple[Run, NDArray[np.float64], NDArray[np.float64]]:
    """Return a run whose ``first`` path took that time [s], its shortened path and the twists."""
    began = time.process_time()
    result = plan(space, *ends, seed=seed, time_limit=LIMIT)
    whole = time.process_time() - began
    if result.status is not PlannerStatus.SOLVED or first == math.inf:
        return Run(math.inf, math.inf, math.inf, 0), np.empty((0, 3)), np.empty((0, 3))
    places = [space.disc.place(end) for end in ends]
    shortest = plan(space.disc.space, *places, algorithm='polyanya', time_limit=math.inf).length
    ways = np.sign(result.twists[result.twists[:, 0] != 0.0, 0])
    reversals = int(np.count_nonzero(ways[1:] != ways[:-1]))
    run = Run(first, whole, result.length / shortest, reversals)
    return run, result.path, result.twists


def _words(row: Row) -> list[str]:
    """Return one row of the table."""
    solved = [run for run in row.ours if run.length < math.inf]
    several = len(solved) > 0
    ompl = [
        words
        for name in OMPL
        for words in (
            (
                milliseconds(float(np.median(row.ompl[name]))),
                f'{np.isfinite(row.ompl[name]).sum()}/{len(row.ompl[name])}',
            )
            if name in row.ompl
            else ('', '')
        )
    ]
    return [
        row.name,
        row.drive,
        f'{len(solved)}/{len(row.ours)}',
        milliseconds(row.first),
        milliseconds(_tail(row)),
        milliseconds(float(np.median([run.whole for run in row.ours]))),
        ratio(float(np.median([run.length for run in solved]))) if several else '-',
        f'{np.median([run.reversals for run in solved]):g}' if several else '-',
        *ompl,
    ]


def _tail(row: Row) -> float:
    """Return the time within which 95 % of our first paths are found [s]."""
    return float(np.quantile([run.first for run in row.ours], 0.95, method='higher'))


def _verdicts(rows: list[Row]) -> list[Verdict]:
    """Return the verdicts on the targets."""
    verdicts = []
    for row in rows:
        where = f'{row.name}, {row.drive}'
        if row.name in SHARE and row.ompl:
            share = row.over_best()
            verdicts.append(
                Verdict(
                    f'{where}: first drivable path, median',
                    f"{SHARE[row.name]:g} of OMPL's best",
                    f'{share:.2f}',
                    share <= SHARE[row.name],
                )
            )
        if row.name == 'office':
            tail = 1e3 * _tail(row)
            reached = row.success >= 0.99 and row.first <= 6e-3 and tail <= 25.0
            verdicts.append(
                Verdict(
                    f'{where}: success, and first path',
                    '99 %, median 6 ms, 95 % within 25 ms',
                    f'{100 * row.success:.0f} %, {milliseconds(row.first)} ms, {tail:.3g} ms',
                    reached,
                )
            )
    faults = [f'{row.name}, {row.drive}: {row.faults[0]}' for row in rows if row.faults]
    verdicts.append(
        Verdict('poses: our paths that touch something', 'none', f'{len(faults)}', not faults)
    )
    return verdicts
