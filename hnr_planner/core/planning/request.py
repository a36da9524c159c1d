"""A planning request at the door: clean numbers, the problem in kernel form, and refusals."""

from dataclasses import dataclass
from typing import Any

from hnr_planner.core.checks import check_number, check_point, check_seed, Floats
from hnr_planner.core.kernels import kernel
from hnr_planner.core.planning.algorithms import make_planner
from hnr_planner.core.planning.result import PlannerStatus
from hnr_planner.core.planning.search import Planner, Problem
from hnr_planner.core.spaces.primitives import component
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Request:
    """
    A request whose numbers are clean.

    Attributes
    ----------
    space : Space
        Where the path has to be free.
    start, goal : (dim,)
        Caller's frame.
    goal_radius : float
        Caller's units.
    planner : Planner
        Who searches.
    simplify : bool
        Whether the path is shortened.
    seed : int
        What every draw follows from.
    problem : Problem
        The same in the kernel frame.

    """

    space: Space
    start: Floats
    goal: Floats
    goal_radius: float
    planner: Planner
    simplify: bool
    seed: int
    problem: Problem

    def generator(self, *purpose: int) -> np.random.Generator:
        """Return the generator for one purpose: each has its own, all follow from the seed."""
        sequence = np.random.SeedSequence(self.seed, spawn_key=purpose)
        return np.random.Generator(np.random.PCG64(sequence))


def check_request(
    space: Space,
    start: ArrayLike,
    goal: ArrayLike,
    goal_radius: float,
    algorithm: str | Planner,
    settings: dict[str, Any],
    simplify: bool,
    seed: int | None,
) -> Request:
    """Return the request that a caller's arguments make, or raise RequestError."""
    start, goal = check_point('start', start, space.dim), check_point('goal', goal, space.dim)
    goal_radius = check_number('goal_radius', goal_radius, 0.0)
    lower, upper = space.kernel_bounds
    problem = Problem(
        space=space.data,
        lower=lower,
        upper=upper,
        start=space.to_kernel(start),
        goal=space.to_kernel(goal),
        goal_radius=goal_radius / space.scale,
        margin=space.margin,
        clearance=space.typical_clearance,
    )
    planner = make_planner(algorithm, settings)
    return Request(
        space, start, goal, goal_radius, planner, bool(simplify), check_seed(seed), problem
    )


def refusal(request: Request) -> tuple[PlannerStatus, str] | None:
    """Say where no search can help: an end that is not free, or no way between them."""
    space, start, goal = request.space, request.start, request.goal
    start_part, goal_part = _parts(request.problem)
    if start_part == 0:
        message = f'start {_words(start)} is {space.why_not_free(start)}'
        return PlannerStatus.INVALID_START, message
    if start_part == goal_part:
        return None
    if goal_part == 0 and request.goal_radius == 0.0:
        message = f'goal {_words(goal)} is {space.why_not_free(goal)}'
        return PlannerStatus.INVALID_GOAL, message
    around = ''
    if request.goal_radius > 0.0:
        if space.region_reachable(start, goal, request.goal_radius):
            return None
        around = f' or within {request.goal_radius:g} m of it'
    message = f'no path exists from start {_words(start)} to goal {_words(goal)}{around}'
    return (PlannerStatus.UNREACHABLE if goal_part else PlannerStatus.INVALID_GOAL), message


@kernel
def _parts(problem):
    """Return the parts of the space that hold start and goal; 0 where one is not free."""
    return component(problem.space, problem.start), component(problem.space, problem.goal)


def _words(point: Floats) -> str:
    return '(' + ', '.join(f'{x:g}' for x in point) + ')'
