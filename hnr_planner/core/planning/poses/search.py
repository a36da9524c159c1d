"""Planners of paths of poses, and their search."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import with_capacity
from hnr_planner.core.planning.poses.attempt import ADDED_AT_FIRST
from hnr_planner.core.planning.poses.connections import empty_connections, N_MOTIONS
from hnr_planner.core.planning.poses.extensions import N_NEAREST
from hnr_planner.core.planning.poses.found_path import joined_path
from hnr_planner.core.planning.poses.guide import point_of_guide
from hnr_planner.core.planning.poses.steps import N_STROKES
from hnr_planner.core.planning.poses.trees import (
    grow,
    PoseProblem,
    PoseTrees,
    Proposals,
)
from hnr_planner.core.spaces.poses.drive import CAR
from hnr_planner.core.spaces.poses.pose_space import PoseSpace
from hnr_planner.core.trees import NONE
import numpy as np
from numpy.typing import NDArray

#: Rows of a table of vertices at first.
FIRST_ROWS = 1024
#: Distance that a tree tries to get along the guide at first, in strides.
AHEAD = 12.0
#: Most vertices that a transition adds.
N_ADDED = max(N_MOTIONS, N_STROKES)
#: Number of transitions after which an unsolved search follows another guide.
GUIDE_TURN = 200

#: The planners of paths of poses: how each extends its trees. ``hit_and_run`` is the paper's
#: single chain, ``rrt`` a tree that grows towards uniform poses; the others grow two trees.
POSE_PLANNERS = {
    'hit_and_run': Proposals(0.0, 0.0, 0.0, True, 1),
    'rrt': Proposals(0.0, 1.0, 0.0, False, 1),
    'hit_and_run_connect': Proposals(0.7, 0.05, 0.1, False, 2),
    'rrt_connect': Proposals(0.0, 1.0, 0.0, False, 2),
}
#: How ``hit_and_run_connect`` extends the trees of a car that must not reverse: the guide, a path
#: of a disc that turns anywhere, often leads the wrong way from where the car has to turn round.
CONNECT_AHEAD = Proposals(0.2, 0.6, 0.1, False, 2)


def drives_ahead_only(space: PoseSpace) -> bool:
    """Return whether the robot is a car that must not reverse, which never gets back."""
    return space.data.drive == CAR and not space.data.reverse


def proposals_of(name: str, space: PoseSpace) -> Proposals:
    """Return how the planner of a name extends its trees in a space of poses."""
    if name == 'hit_and_run_connect' and drives_ahead_only(space):
        return CONNECT_AHEAD
    return POSE_PLANNERS[name]


@dataclass
class PoseSearch:
    """
    A search for a path of poses, which advances by transitions.

    Parameters
    ----------
    problem : PoseProblem
        The request in the kernel frame.
    proposals : Proposals
        How the trees are extended.
    roots : (k, 3)
        The start, then the poses of the goal, kernel frame, all free.
    rng : Stream
        Random stream.
    other_guide : callable
        Returns a guide (k, 3) from the number of guides before and where to go round: a point (2,)
        in the kernel frame.

    """

    problem: PoseProblem
    proposals: Proposals
    roots: Floats
    rng: Stream
    other_guide: Callable[[int, Floats], Floats]
    iterations: int = field(init=False, default=0)
    solved: bool = field(init=False, default=False)
    _size: int = field(init=False)
    _trees: PoseTrees = field(init=False)
    _joined: tuple[int, int, int] = field(init=False, default=(NONE, NONE, NONE))

    def __post_init__(self) -> None:
        self._size = len(self.roots)
        self._trees = PoseTrees(
            np.empty((FIRST_ROWS, 3)),
            np.empty((FIRST_ROWS, 3)),
            np.empty(FIRST_ROWS, dtype=np.int64),
            np.empty(FIRST_ROWS, dtype=np.int64),
            empty_connections(),
            np.empty(N_NEAREST, dtype=np.int64),
            np.empty(N_NEAREST),
            np.empty((3, 3)),
            np.empty(2),
            np.empty(2),
        )
        self._reserve(self._size)
        trees = self._trees
        trees.poses[: self._size] = self.roots
        trees.parents[: self._size] = NONE
        trees.owners[: self._size] = 1
        trees.owners[0] = 0
        self._begin_guide()

    @property
    def samples(self) -> Floats:
        """Vertices (k, 3) of both trees, kernel frame, the roots first."""
        return self._trees.poses[: self._size]

    @property
    def parents(self) -> NDArray[np.int64]:
        """Row (k,) of the vertex that each was reached from; -1 for a root."""
        return self._trees.parents[: self._size]

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name: none."""
        return {}

    def advance(self, n_iterations: int) -> None:
        """
        Handle at most ``n_iterations`` further transitions, fewer once the search is solved.

        Every ``GUIDE_TURN`` transitions the trees follow another guide, where they have one.
        """
        end = self.iterations + n_iterations
        while not self.solved and self.iterations < end:
            turn, handled = divmod(self.iterations, GUIDE_TURN)
            if turn > 0 and handled == 0 and len(self.problem.guide) > 0:
                self._follow(turn)
            self._grow(min(end - self.iterations, GUIDE_TURN - handled))

    def _follow(self, turn: int) -> None:
        """Follow another guide from now on, from its ends."""
        stuck = point_of_guide(self.problem.guide, float(self._trees.progress.mean()))
        guide = self.other_guide(turn, stuck)
        self.problem = self.problem._replace(guide=guide)
        self._begin_guide()

    def _begin_guide(self) -> None:
        """Begin to follow the guide of the problem, from its ends."""
        guide, trees = self.problem.guide, self._trees
        trees.progress[0] = 0.0
        trees.progress[1] = guide[-1, 2] if len(guide) else 0.0
        trees.ahead[:] = AHEAD * self.problem.space.stride

    def _grow(self, n_iterations: int) -> None:
        """Handle at most ``n_iterations`` further transitions, with one guide."""
        self._reserve(self._size + ADDED_AT_FIRST + N_ADDED * n_iterations + 1)
        self._size, taken, *joined = grow(
            self.problem,
            self.proposals,
            self._trees,
            self._size,
            self.iterations,
            n_iterations,
            self.rng,
        )
        self.iterations += taken
        self._joined = (joined[0], joined[1], joined[2])
        self.solved = joined[0] != NONE

    @property
    def path(self) -> tuple[Floats, Floats]:
        """
        Path of a solved search, kernel frame: poses (m + 1, 3) and twists (m, 3).

        It has at least one motion, of the zero twist where the goal is the start.
        """
        return joined_path(self._trees, *self._joined)

    def _reserve(self, rows: int) -> None:
        """Make room for a number of vertices."""
        if rows <= len(self._trees.poses):
            return
        grown: dict[str, Any] = {
            name: with_capacity(getattr(self._trees, name), rows)
            for name in ('poses', 'twists', 'parents', 'owners')
        }
        self._trees = self._trees._replace(**grown)
