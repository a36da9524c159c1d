"""
Planner for the double integrator: come to rest, find a path, drive it from stop to stop.

A double integrator at rest can follow every free polyline if it stops at each vertex. So the
planner first brings the robot to rest, then finds a path for a point without inertia, by trees of
Hit-and-Run steps from both ends (``hit_and_run_connect``), and drives that path. ``shorten`` then
makes the motion fast.
"""

from dataclasses import dataclass, field
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import (
    PathSearch,
    Problem,
    reaches_goal,
    to_goal,
    with_capacity,
)
from hnr_planner.core.planning.planners.hit_and_run_connect import HitAndRunConnect
from hnr_planner.core.trajectories.problem import (
    Boundary,
    KinodynamicProblem,
    Motion,
    SHORTEST_STEP,
)
from hnr_planner.core.trajectories.rest import come_to_rest
from hnr_planner.core.trajectories.steps import first_step, motion_to, Steps
from hnr_planner.core.trajectories.stops import drive_stops, shorten_stops
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class KinodynamicConnect:
    """A planner that drives the path found by trees of Hit-and-Run steps; it has no settings."""

    name: ClassVar[str] = 'kinodynamic_connect'
    boundary: ClassVar[Boundary] = 'forbidden'
    samples_goal: ClassVar[bool] = False

    def start(self, problem: KinodynamicProblem, rng: Stream) -> 'KinodynamicConnectSearch':
        """Return a search that begins at the start of ``problem``, with a random stream."""
        return KinodynamicConnectSearch(problem, rng)


@dataclass
class KinodynamicConnectSearch:
    """A running search: first for a state at rest, then for a path from that state to the goal."""

    problem: KinodynamicProblem
    rng: Stream
    _n_rows: int = field(init=False, default=1)
    _steps: Steps = field(init=False)
    _n_braking: int = field(init=False, default=0)
    #: Row of the table whose state is at rest (NONE before there is one), the problem of a path
    #: from that state to the goal, and the search for such a path.
    _rest_row: int = field(init=False, default=NONE)
    _from_rest: Problem = field(init=False)
    _path_search: PathSearch | None = field(init=False, default=None)
    _is_direct: bool = field(init=False, default=False)

    def __post_init__(self) -> None:
        self._steps = first_step(self.problem)

    @property
    def iterations(self) -> int:
        """Number of transitions: of the tree that comes to rest plus those of the path search."""
        path_steps = 0 if self._path_search is None else self._path_search.iterations
        return self._n_braking + path_steps

    @property
    def solved(self) -> bool:
        """Whether a path from the state at rest to the goal is found."""
        return self._is_direct or (self._path_search is not None and self._path_search.solved)

    @property
    def samples(self) -> Floats:
        """Positions (k, dim) of the tree that comes to rest, then samples of the path search."""
        before = self._steps.states[: self._n_rows, : len(self.problem.geometric.goal)]
        if self._path_search is None:
            return before
        return np.vstack([before, self._path_search.samples])

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) into ``samples`` of the parent of each sample; -1 for the roots of trees."""
        before = self._steps.parents[: self._n_rows]
        if self._path_search is None:
            return before
        after = self._path_search.parents
        return np.append(before, np.where(after == NONE, NONE, after + self._n_rows))

    @property
    def counts(self) -> dict[str, int]:
        """Number of transitions of the tree that comes to rest, as ``braking_steps``."""
        return {'braking_steps': self._n_braking}

    @property
    def motion(self) -> Motion:
        """The motion to rest, then from vertex to vertex of the path found."""
        return self._driven(self._stops)

    def draft(self, motion: Motion) -> Motion:
        """Return the motion to rest, then along the path shortened by free straight segments."""
        return self._driven(shorten_stops(self._from_rest, self._stops))

    @property
    def _stops(self) -> Floats:
        if self._path_search is not None:
            return self._path_search.path
        return to_goal(self._from_rest, self._from_rest.start[np.newaxis])

    def _driven(self, stops: Floats) -> Motion:
        durations, states, controls = motion_to(self._steps, self._rest_row)
        more = drive_stops(self.problem.system, stops)
        if len(durations) + len(more[0]) == 0:
            # At rest next to the goal: one step of the shortest duration.
            ends = np.stack([states[0], states[0]])
            ends[-1, : stops.shape[1]] = stops[-1]
            return Motion(np.array([SHORTEST_STEP]), ends, np.zeros((1, stops.shape[1])))
        return Motion(
            np.append(durations, more[0]),
            np.vstack([states[:-1], more[1]]),
            np.vstack([controls, more[2]]),
        )

    def advance(self, n_iterations: int) -> None:
        """Take at most ``n_iterations`` further steps; none once the search is solved."""
        if self.solved:
            return
        if self._rest_row == NONE:
            self._come_to_rest(n_iterations)
        elif self._path_search is not None:
            self._path_search.advance(n_iterations)

    def _come_to_rest(self, n_iterations: int) -> None:
        rows = self._n_rows + n_iterations + 2
        self._steps = Steps(*(with_capacity(column, rows) for column in self._steps))
        self._n_rows, taken, self._rest_row = come_to_rest(
            self.problem, self.rng, self._steps, self._n_rows, n_iterations
        )
        self._n_braking += taken
        if self._rest_row == NONE:
            return
        rest = self._steps.states[self._rest_row, : len(self.problem.geometric.goal)]
        self._from_rest = self.problem.geometric._replace(start=rest)
        self._is_direct = is_direct(self._from_rest)
        if not self._is_direct:
            self._path_search = HitAndRunConnect().start(self._from_rest, self.rng)


@kernel
def is_direct(geometric):
    """Return whether the start lies in the goal region, or sees a goal without a radius."""
    return reaches_goal(geometric, geometric.start)
