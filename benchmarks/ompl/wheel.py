"""
Run OMPL's wheel: ``python -m benchmarks.ompl.wheel SEED``, with the protocol of ``planners.cpp``.

Its bindings take motion validators written in Python only. This one hands four numbers to compiled
code, which traverses the grid exactly; the way through Python costs more than the traversal.
AORRTC, which came with OMPL 2.0, is left out: in the wheel of 2.0.1 it ends in a crash.
"""

from __future__ import annotations

import os
import sys
import time

from benchmarks.ompl.driver import Floats, read_grid
from hnr_planner.core import GridSpace
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.grid.traversal import GridData
from hnr_planner.core.spaces.primitives import contains, segment_is_free
import numpy as np
from ompl import base, geometric, util

PLANNERS = {
    name: getattr(geometric, name)
    for name in ('RRTConnect', 'BKPIECE1', 'KPIECE1', 'RRT', 'RRTstar', 'BITstar')
}
SIMPLIFY = '+simplify'


class GridTraversal(base.MotionValidator):
    """Motion validator that traverses the cells of a grid exactly."""

    def __init__(self, si: base.SpaceInformation, grid: GridData) -> None:
        super().__init__(si)
        self.free_distance, self.labels = grid

    def checkMotion(self, a: base.State, b: base.State) -> bool:
        """Return whether the segment between two states is free."""
        return _is_motion_free(self.free_distance, self.labels, a[0], a[1], b[0], b[1])


@kernel
def _is_motion_free(free_distance, labels, ax, ay, bx, by):
    return segment_is_free(GridData(free_distance, labels), np.array((ax, ay)), np.array((bx, by)))


@kernel
def _is_free(free_distance, labels, x, y):
    return contains(GridData(free_distance, labels), np.array((x, y)))


class Course:
    """A grid, and OMPL's setup for planning on it."""

    def __init__(self, file: str) -> None:
        blocked = read_grid(file)
        grid = GridSpace.from_blocked(blocked[1:-1, 1:-1]).data
        space, bounds = base.RealVectorStateSpace(2), base.RealVectorBounds(2)
        for axis, cells in enumerate(reversed(blocked.shape)):
            bounds.setLow(axis, 1.0)
            bounds.setHigh(axis, cells - 1.0)
        space.setBounds(bounds)
        self.si = base.SpaceInformation(space)
        self.si.setStateValidityChecker(lambda state: _is_free(*grid, state[0], state[1]))
        self.si.setMotionValidator(GridTraversal(self.si, grid))
        self.si.setup()

    def answer(self, planner: str, seconds: float, *ends: float) -> tuple[float, Floats]:
        """Return the seconds and the path (m, 2)."""
        start, goal = self.si.allocState(), self.si.allocState()
        start[0:2], goal[0:2] = ends[:2], ends[2:]
        problem = base.ProblemDefinition(self.si)
        problem.setStartAndGoalStates(start, goal)
        problem.setOptimizationObjective(base.PathLengthOptimizationObjective(self.si))
        return self._solve(planner, seconds, problem)

    def _solve(
        self, planner: str, seconds: float, problem: base.ProblemDefinition
    ) -> tuple[float, Floats]:
        name = planner.removesuffix(SIMPLIFY)
        solver, states = PLANNERS[name](self.si), []
        solver.setProblemDefinition(problem)
        began = time.perf_counter()
        solver.setup()
        solver.solve(seconds)
        if problem.hasExactSolution():
            path = problem.getSolutionPath()
            if name != planner:
                geometric.PathSimplifier(self.si, problem.getGoal()).simplifyMax(path)
            states = path.getStates()
        spent = time.perf_counter() - began
        return spent, np.array([(state[0], state[1]) for state in states]).reshape(-1, 2)


def main(seed: int) -> None:
    """Answer requests from standard input."""
    util.setLogLevel(util.LogLevel.LOG_NONE)
    util.RNG.setSeed(seed)
    for line in sys.stdin:
        word, *words = line.split()
        if word == 'grid':
            course = Course(*words)
        else:
            seconds, path = course.answer(word, *map(float, words))
            numbers = ' '.join(f'{value:.17g}' for value in path.ravel())
            print(f'{seconds:.17g} {len(path)} {numbers}', flush=True)
    sys.stdout.flush()
    os._exit(0)  # the bindings would complain at length about objects that are still there


if __name__ == '__main__':
    main(int(sys.argv[1]))
