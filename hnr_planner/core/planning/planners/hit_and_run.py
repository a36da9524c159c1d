"""
Hit-and-Run as a planner (paper, Section 1).

From the start the planner takes one Hit-and-Run step after another, until the goal is visible from
a sample or, with a goal radius, a sample lies in the goal region. Each step
lies on a chord and so is free of collision: the chain itself is the path, without a tree.
"""

from dataclasses import dataclass, field
from typing import ClassVar

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.planner import Problem, reaches_goal, to_goal, with_capacity
from hnr_planner.core.sampling.draws import hit_and_run_step
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class HitAndRun:
    """The paper's planner Hit-and-Run: one chain from the start. It has no settings."""

    name: ClassVar[str] = 'hit_and_run'

    def start(self, problem: Problem, rng: Stream) -> 'HitAndRunSearch':
        """Return a search whose chain begins at the problem's start."""
        return HitAndRunSearch(problem, rng)


@dataclass
class HitAndRunSearch:
    """Search by one chain of Hit-and-Run steps; ``iterations`` counts the steps."""

    problem: Problem
    rng: Stream
    solved: bool = field(init=False, default=False)
    taut: ClassVar[bool] = False
    redraws: int = field(init=False, default=0)
    _chain: Floats = field(init=False)
    _length: int = field(init=False, default=1)

    def __post_init__(self) -> None:
        self._chain = self.problem.start[np.newaxis].copy()

    @property
    def iterations(self) -> int:
        """Number of steps taken."""
        return self._length - 1

    @property
    def samples(self) -> Floats:
        """Points (k, dim) of the chain, kernel frame, the start first."""
        return self._chain[: self._length]

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (k,) of the sample before each sample; -1 for the start."""
        return np.arange(-1, self._length - 1)

    @property
    def path(self) -> Floats:
        """Path (m, dim) of a solved search: the whole chain, then the goal if that is exact."""
        return to_goal(self.problem, self.samples)

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name: ``redraws``, draws repeated since they fell on the boundary."""
        return {'redraws': self.redraws}

    def advance(self, n_iterations: int) -> None:
        """Take ``n_iterations`` further steps, or fewer where the search is solved before."""
        if self.solved:
            return
        end = self._length + n_iterations
        self._chain = with_capacity(self._chain, end)
        self._length, self.solved, redraws = _walk(
            self.problem, self.rng, self._chain, self._length, end
        )
        self.redraws += redraws


@kernel
def _walk(problem, rng, chain, length, end):
    """
    Extend the ``length`` samples of ``chain`` until the goal is reached or there are ``end``.

    Returns (number of samples, whether the goal is reached, redraws).
    """
    problem, rng, chain = borrowed(problem), borrowed(rng), borrowed(chain)
    redraws = 0
    for k in range(length, end):
        redraws += hit_and_run_step(problem.space, chain[k - 1], rng, chain[k])
        if reaches_goal(problem, chain[k]):
            return k + 1, True, redraws
    return end, False, redraws
