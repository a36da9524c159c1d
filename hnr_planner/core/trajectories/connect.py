"""
The hybrid: come to rest, find a way, drive it from stop to stop.

A double integrator at rest can follow every free polyline, stopping at its vertices. So, beyond
coming to rest, finding a motion is no harder than finding a path, and trees of Hit-and-Run steps
from both ends (``hit_and_run_connect``) find one soon. ``shorten_in_time`` then makes it fast.

A start in motion is braked straight. Where the boundary is in the way, a tree grows from it by
Hit-and-Run on curves: a uniform direction of full acceleration, and a uniform time until the curve
meets the boundary or the limit on speed; until one of its states can be braked.
"""

from dataclasses import dataclass, field
import math
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, uniform
from hnr_planner.core.lengths import distance, norm
from hnr_planner.core.planning.homology import NO_ISLANDS
from hnr_planner.core.planning.planner import (
    compile_search,
    PathSearch,
    Problem,
    reaches_goal,
    to_goal,
    with_room,
)
from hnr_planner.core.planning.planners.hit_and_run_connect import HitAndRunConnect
from hnr_planner.core.planning.postprocessing.shortcuts import pull, skip
from hnr_planner.core.sampling.draws import draw_direction
from hnr_planner.core.systems.primitives import brake, contact, move
from hnr_planner.core.trajectories.problem import (
    Boundary,
    KinodynamicProblem,
    Motion,
)
from hnr_planner.core.trajectories.steps import can_brake, first_step, motion_to, Steps
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Visibility tests that make the way shorter before it is driven.
TESTS = 2000
#: The longest step of a start that cannot be braked straight, in units of the time to brake.
HORIZON = 2.0
#: Part of the steps that such a start takes itself: of the states that come of it most are doomed.
FROM_START = 0.5


@dataclass(frozen=True)
class KinodynamicConnect:
    """Drive the way that trees of Hit-and-Run steps find. It has no settings."""

    name: ClassVar[str] = 'kinodynamic_connect'
    boundary: ClassVar[Boundary] = 'forbidden'
    samples_goal: ClassVar[bool] = False

    def start(self, problem: KinodynamicProblem, rng: Stream) -> 'KinodynamicConnectSearch':
        """Start at the problem's start."""
        return KinodynamicConnectSearch(problem, rng)


@dataclass
class KinodynamicConnectSearch:
    """A search under way: first for a place to rest at, then for a way from there."""

    problem: KinodynamicProblem
    rng: Stream
    _n_rows: int = field(init=False, default=1)
    _steps: Steps = field(init=False)
    _n_braking: int = field(init=False, default=0)
    #: Row of the table that is at rest, the problem of going on from there, and its search.
    _rest: int = field(init=False, default=NONE)
    _place: Problem = field(init=False)
    _way: PathSearch | None = field(init=False, default=None)
    _at_once: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        self._steps = first_step(self.problem.start, len(self.problem.geometric.goal))

    @property
    def iterations(self) -> int:
        """Steps of the tree that comes to rest, and of those that find the way."""
        return self._n_braking + (self._way.iterations if self._way is not None else 0)

    @property
    def solved(self) -> bool:
        """Whether the way is found."""
        return self._at_once or (self._way is not None and self._way.solved)

    @property
    def samples(self) -> Floats:
        """Positions of the tree that comes to rest, then vertices of the trees from there."""
        before = self._steps.states[: self._n_rows, : len(self.problem.geometric.goal)]
        return before if self._way is None else np.vstack([before, self._way.samples])

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) of the sample that each was reached from; -1 for the roots."""
        before = self._steps.parents[: self._n_rows]
        if self._way is None:
            return before
        after = self._way.parents
        return np.append(before, np.where(after == NONE, NONE, after + self._n_rows))

    @property
    def counts(self) -> dict[str, int]:
        """Steps that it took to come to rest."""
        return {'braking_steps': self._n_braking}

    @property
    def motion(self) -> Motion:
        """To rest, and on from stop to stop."""
        durations, states, controls = motion_to(self._steps, self._rest)
        stops = _fewer(self._place, self._stops)
        more = drive_stops(self.problem.system, stops)
        return Motion(
            np.append(durations, more[0]),
            np.vstack([states[:-1], more[1]]),
            np.vstack([controls, more[2]]),
        )

    @property
    def _stops(self) -> Floats:
        if self._way is not None:
            return self._way.path
        return to_goal(self._place, self._place.start[np.newaxis])

    def advance(self, n_iterations: int) -> None:
        """Take at most ``n_iterations`` further steps."""
        if self.solved:
            return
        if self._rest == NONE:
            self._come_to_rest(n_iterations)
        elif self._way is not None:
            self._way.advance(n_iterations)

    def _come_to_rest(self, n_iterations: int) -> None:
        self._steps = Steps(*(with_room(c, self._n_rows + n_iterations + 2) for c in self._steps))
        self._n_rows, taken, self._rest = come_to_rest(
            self.problem, self.rng, self._steps, self._n_rows, n_iterations
        )
        self._n_braking += taken
        if self._rest == NONE:
            return
        dim = len(self.problem.geometric.goal)
        self._place = self.problem.geometric._replace(start=self._steps.states[self._rest, :dim])
        self._at_once = is_in_sight(self._place)
        if not self._at_once:
            self._way = HitAndRunConnect().start(self._place, self.rng)


def compile_connect(problem: KinodynamicProblem) -> None:
    """Compile what a search runs once its start is at rest, without searching."""
    geometric = problem.geometric._replace(start=problem.geometric.lower)
    is_in_sight(geometric)
    motion_to(first_step(problem.start, len(geometric.goal)), 0)
    compile_search(HitAndRunConnect(), geometric)
    drive_stops(problem.system, _fewer(geometric, np.stack([geometric.start, geometric.start])))


@kernel
def is_in_sight(geometric):
    """Say whether the start reaches the goal as it is."""
    return reaches_goal(geometric, geometric.start)


@kernel
def come_to_rest(problem, rng, steps, n_rows, n_iterations):
    """Grow the tree until a state can be braked: (rows, transitions, row at rest or NONE)."""
    if n_rows == 1 and can_brake(problem, steps.states[0], steps.controls.shape[1]):
        n_rows = _braked(problem.system, steps, n_rows, 0)
        return n_rows, 0, n_rows - 1
    for k in range(n_iterations):
        row = 0 if uniform(rng) < FROM_START else math.floor(uniform(rng) * n_rows)
        if not _curve_step(problem, rng, steps, row, n_rows):
            continue
        n_rows += 1
        if can_brake(problem, steps.states[n_rows - 1], steps.controls.shape[1]):
            n_rows = _braked(problem.system, steps, n_rows, n_rows - 1)
            return n_rows, k + 1, n_rows - 1
    return n_rows, n_iterations, NONE


@kernel
def _braked(system, steps, n_rows, row):
    """Add the row that braking ``row`` leads to, unless that is at rest: the rows."""
    state, control, end = steps.states[row], steps.controls[n_rows], steps.states[n_rows]
    duration = brake(system, state, control)
    if duration == 0.0:
        return n_rows
    move(system, state, control, duration, end)
    dim = len(control)
    end[dim:] = 0.0
    steps.parents[n_rows], steps.durations[n_rows] = row, duration
    return n_rows + 1


@kernel
def _curve_step(problem, rng, steps, row, n_rows):
    """Write a step of Hit-and-Run on curves from ``row``; False where there is no room."""
    system = problem.system
    state, control, end = steps.states[row], steps.controls[n_rows], steps.states[n_rows]
    dim = len(control)
    draw_direction(rng, control)
    speed, along = norm(state[dim:]), 0.0
    for i in range(dim):
        control[i] *= system.max_acceleration
        along += control[i] * state[dim + i]
    pull = system.max_acceleration
    spare = max(system.max_speed**2 - speed * speed, 0.0)
    until_fastest = (math.sqrt(along * along + pull * pull * spare) - along) / (pull * pull)
    longest = min(until_fastest, HORIZON * system.max_speed / pull)
    met = contact(system, problem.geometric.space, state, control, longest)
    duration = uniform(rng) * min(met, longest)
    move(system, state, control, duration, end)
    steps.parents[n_rows], steps.durations[n_rows] = row, duration
    return duration > 0.0 and norm(end[dim:]) <= system.max_speed


def _fewer(geometric: Problem, stops: Floats) -> Floats:
    """Leave out the stops (m, dim) that are not needed, and pull the way taut."""
    kept = np.zeros(len(stops), dtype=np.int64)
    n_kept, _ = skip(geometric.space, NO_ISLANDS, stops, kept, 1, True, TESTS)
    beyond = kept[n_kept - 1] + 1
    left = np.concatenate([stops[kept[:n_kept]], stops[beyond:]])
    taut: Floats
    taut, _, _ = pull(geometric.space, NO_ISLANDS, left, 1, geometric.margin, TESTS)
    return taut


@kernel
def drive_stops(system, stops):
    """Return the motion (durations, states, controls) that rests at each of ``stops``."""
    n, dim = len(stops) - 1, stops.shape[1]
    durations, controls = np.empty(3 * n + 1), np.zeros((3 * n + 1, dim))
    states = np.zeros((3 * n + 2, 2 * dim))
    states[0, :dim] = stops[0]
    rows = 0
    for k in range(n):
        way = distance(stops[k], stops[k + 1])
        if way == 0.0:
            continue
        u = (stops[k + 1] - stops[k]) / way
        speed = min(math.sqrt(system.max_acceleration * way), system.max_speed)
        ramp = speed / system.max_acceleration
        cruise = way / speed - ramp
        for sign, duration in ((1.0, ramp), (0.0, cruise), (-1.0, ramp)):
            if duration <= 1e-12 * ramp:
                continue
            durations[rows] = duration
            for i in range(dim):
                controls[rows, i] = sign * system.max_acceleration * u[i]
            move(system, states[rows], controls[rows], duration, states[rows + 1])
            rows += 1
        states[rows, :dim], states[rows, dim:] = stops[k + 1], 0.0
    if rows == 0:
        durations[0], states[1], rows = 0.0, states[0], 1
    return durations[:rows], states[: rows + 1], controls[:rows]
