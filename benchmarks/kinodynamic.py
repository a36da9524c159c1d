"""Section: robots with inertia, the double integrator against OMPL's control planners."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
import math
from test.curve_brute_force import double_integrator_faults
from typing import NamedTuple

from benchmarks.made_maps import slanted_z
from benchmarks.ompl.control import ControlSession
from benchmarks.ompl.driver import MissingOmpl
from benchmarks.problems import Floats, Problem
from benchmarks.progress import show
from benchmarks.sections import Bench, milliseconds, on_all, Section, table
from hnr_planner.core import GridSpace, plan_trajectory
from hnr_planner.core.systems import DoubleIntegrator
from hnr_planner.maps import serpentine
import numpy as np

#: The robot, and the radius of the goal's region [m].
SYSTEM = DoubleIntegrator(dim=2, max_acceleration=1.0, max_speed=2.0)
RADIUS = 0.5
#: Duration of a step of OMPL's propagation [s].
STEP = 0.1
#: OMPL's planners that take part.
OMPL = ('RRT', 'SST', 'KPIECE1', 'EST')
#: Time limit for a first trajectory, and time to use for a short one [s].
LIMIT, LONG = 5.0, 1.0
#: Runs for each request.
RUNS, RUNS_QUICK = 7, 2
#: Target: our time over that of the fastest of OMPL's planners.
HALF = 0.5

EXPLAINED = """\
All start at rest, drive into the same region and may touch nothing; acceleration (1 m/s^2) and
speed (2 m/s) are bounded, and every motion is tested exactly along its parabolas, by everybody and
once more by an independent checker. Times to the first trajectory are medians in milliseconds."""


class Run(NamedTuple):
    """Time to the answer and duration of the trajectory [s]; inf where there is none."""

    seconds: float
    duration: float


class Row(NamedTuple):
    """Runs on one corridor: for a first trajectory by planner, and of ``LONG`` seconds each."""

    name: str
    first: dict[str, list[Run]]
    ours: list[Run]
    sst: list[Run]

    def seconds(self, planner: str) -> float:
        """Median time to the first trajectory."""
        return float(np.median([run.seconds for run in self.first[planner]]))

    @property
    def fastest(self) -> str:
        """The fastest of OMPL's planners on this course."""
        return min((name for name in self.first if name != 'ours'), key=self.seconds)

    def success(self, planner: str) -> float:
        """Fraction of the runs that found a trajectory."""
        return float(np.mean([run.duration < math.inf for run in self.first[planner]]))


def kinodynamic(bench: Bench) -> Section:
    """Compare on corridors and on two robot maps."""
    title = 'Robots with inertia'
    try:
        session = ControlSession()
    except MissingOmpl as reason:
        return Section(title, f'**Missing.** {reason}')
    with closing(session):
        rows = [_measure(course, session, bench.quick) for course in _courses(bench)]
    slow = {
        row.name: f'{row.seconds("ours") / row.seconds(row.fastest):.2f} x'
        for row in rows
        if not row.seconds('ours') <= HALF * row.seconds(row.fastest)
    }
    long = {
        row.name: f'{_duration(row.ours):.3g} s'
        for row in rows
        if not _duration(row.ours) <= _duration(row.sst)
    }
    failed = {
        row.name: f'{100 * row.success("ours"):.0f} %' for row in rows if row.success('ours') < 1.0
    }
    verdicts = [
        on_all('first trajectory, median', "half of OMPL's fastest there", slow, len(rows)),
        on_all('duration after 1 s, median', "SST's", long, len(rows)),
        on_all('trajectories within 5 s', 'all', failed, len(rows)),
    ]
    head = ' | '.join(
        [
            'course | first, ours',
            *OMPL,
            'found, ours',
            *(f'found, {name}' for name in OMPL),
            'duration after 1 s, ours',
            'SST',
        ]
    )
    return Section(title, f'{EXPLAINED}\n\n{table(head, map(_words, rows))}', verdicts)


def _courses(bench: Bench) -> list[Problem]:
    """Return serpentines, a Z and two robot maps, with few requests on each."""
    corridors = {f'serpentine {width:g}': serpentine(width) for width in (1.0, 2.0, 3.0)}
    corridors['Z 1.5'] = slanted_z(1.5)
    courses = [
        Problem(
            name,
            GridSpace.from_blocked(made.blocked, made.resolution),
            np.array([[made.start, made.goal]]),
        )
        for name, made in corridors.items()
    ]
    robots = [problem for problem in bench.problems if problem.name in ('office', 'depot')]
    return courses + [problem.with_requests(problem.requests[:5]) for problem in robots]


def _measure(course: Problem, session: ControlSession, quick: bool) -> Row:
    """Return the runs on one corridor, in turns, so that other load affects all planners alike."""
    runs = RUNS_QUICK if quick else RUNS
    row = Row(course.name, {name: [] for name in ('ours', *OMPL)}, [], [])
    session.use(course.blocked_in_kernel)
    _ours(course, course.requests[0], 0, simplify=False)  # for the caches, not for the record
    for k in range(runs):
        request = course.requests[k % len(course.requests)]
        show(f'{course.name}: with inertia, run {k + 1} of {runs}')
        row.first['ours'].append(_ours(course, request, k, simplify=False))
        for name in OMPL:
            row.first[name].append(_ompl(course, request, session, f'{name}+first', LIMIT))
        row.ours.append(_ours(course, request, k, optimize_for=LONG))
        row.sst.append(_ompl(course, request, session, 'SST', LONG))
    return row


def _ours(course: Problem, request: Floats, seed: int, **settings: float) -> Run:
    start, goal = np.append(request[0], (0.0, 0.0)), request[1]
    result = plan_trajectory(
        course.space,
        SYSTEM,
        start,
        goal,
        goal_radius=RADIUS,
        seed=seed,
        time_limit=LIMIT,
        **settings,  # type: ignore[arg-type]
    )
    if result.trajectory is None:
        return Run(math.inf, math.inf)
    states = SYSTEM.to_kernel(course.space, result.trajectory.states)
    controls = SYSTEM.controls_to_kernel(course.space, result.trajectory.controls)
    judged = _judged(course, result.trajectory.times, states, controls)
    return Run(result.elapsed, result.trajectory.duration) if judged else Run(math.inf, math.inf)


def _ompl(
    course: Problem, request: Floats, session: ControlSession, planner: str, seconds: float
) -> Run:
    scale = course.space.scale
    ends = course.space.to_kernel(request).ravel()
    limits = SYSTEM.max_acceleration / scale, SYSTEM.max_speed / scale
    motion = session.drive(planner, (seconds, *limits, STEP, RADIUS / scale, *ends))
    if not len(motion.times) or not _judged(course, motion.times, motion.states, motion.controls):
        return Run(math.inf, math.inf)
    return Run(motion.seconds, float(motion.times[-1]))


def _judged(course: Problem, times: Floats, states: Floats, controls: Floats) -> bool:
    """Return whether the independent checker finds no fault."""
    scale = course.space.scale
    limits = {
        'max_acceleration': SYSTEM.max_acceleration / scale,
        'max_speed': SYSTEM.max_speed / scale,
    }
    return not double_integrator_faults(
        times, states, controls, course.blocked_in_kernel, **limits
    )


def _duration(runs: Sequence[Run]) -> float:
    return float(np.median([run.duration for run in runs]))


def _words(row: Row) -> list[str]:
    planners = ('ours', *OMPL)
    return [
        row.name,
        *(milliseconds(row.seconds(name)) for name in planners),
        *(f'{100 * row.success(name):.0f} %' for name in planners),
        *(_seconds(_duration(runs)) for runs in (row.ours, row.sst)),
    ]


def _seconds(duration: float) -> str:
    return f'{duration:.3g} s' if duration < math.inf else '-'
