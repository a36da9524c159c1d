"""Planners of paths of poses, and their search."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import with_capacity
from hnr_planner.core.planning.poses.connections import empty_connections, N_MOTIONS
from hnr_planner.core.planning.poses.guide import point_of_guide
from hnr_planner.core.planning.poses.steps import N_STROKES
from hnr_planner.core.planning.poses.trees import (
    grow,
    N_NEAREST,
    PoseProblem,
    PoseTrees,
    Proposals,
)
from hnr_planner.core.spaces.poses.motion import orbit_poses
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
        self._size, guide = len(self.roots), self.problem.guide
        self._trees = PoseTrees(
            np.zeros((FIRST_ROWS, 3)),
            np.zeros((FIRST_ROWS, 3)),
            np.full(FIRST_ROWS, NONE),
            np.zeros(FIRST_ROWS, dtype=np.int64),
            empty_connections(),
            np.zeros(N_NEAREST, dtype=np.int64),
            np.zeros(N_NEAREST),
            np.zeros((3, 3)),
            np.array([0.0, guide[-1, 2] if len(guide) else 0.0]),
            np.full(2, AHEAD * self.problem.space.stride),
        )
        self._reserve(self._size)
        self._trees.poses[: self._size] = self.roots
        self._trees.owners[1:][: len(self.roots) - 1] = 1

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
        self._trees.progress[:] = 0.0, guide[-1, 2] if len(guide) else 0.0
        self._trees.ahead[:] = AHEAD * self.problem.space.stride

    def _grow(self, n_iterations: int) -> None:
        """Handle at most ``n_iterations`` further transitions, with one guide."""
        self._reserve(self._size + N_ADDED * n_iterations + 1)
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
        first, last, k = self._joined
        trees = self._trees
        ahead, back = self._to_root(first)[::-1], self._to_root(last)
        n = trees.found.sizes[k]
        middle = trees.found.twists[k, :n]
        # The motions of the goal's tree lead away from the goal: they are driven back.
        twists = np.concatenate([trees.twists[ahead[1:]], middle, -trees.twists[back[:-1]]])
        poses = [*trees.poses[ahead]]
        for twist in middle[:-1]:
            poses.append(after(poses[-1], twist))
        if n > 0 or len(twists) == 0:
            poses.append(trees.poses[back[0]])
        poses += [*trees.poses[back[1:]]]
        return np.array(poses), twists if len(twists) else np.zeros((1, 3))

    def _to_root(self, row: int) -> list[int]:
        """Return the rows from a vertex to the root of its tree."""
        rows = [row]
        while self._trees.parents[rows[-1]] != NONE:
            rows.append(int(self._trees.parents[rows[-1]]))
        return rows

    def _reserve(self, rows: int) -> None:
        """Make room for a number of vertices."""
        if rows <= len(self._trees.poses):
            return
        grown: dict[str, Any] = {
            name: with_capacity(getattr(self._trees, name), rows)
            for name in ('poses', 'twists', 'parents', 'owners')
        }
        size = self._size
        grown['parents'][size:] = NONE
        self._trees = self._trees._replace(**grown)


def after(pose: Floats, twist: Floats) -> Floats:
    """Return the pose (3,) after a twist (3,) was held for one unit of time, kernel frame."""
    reached: Floats = orbit_poses(pose, twist, np.ones(1))[0]
    return reached
