"""Build the result of ``plan`` from the outcome of its searches, or from one without a search."""

import math

from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.attempts import Attempt, with_clearance
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import Work
from hnr_planner.core.planning.request import Request
from hnr_planner.core.planning.result import (
    FirstSolution,
    PlannerStatus,
    PlanResult,
    proof,
    proof_of_clearance,
)
from hnr_planner.core.trees import NONE
import numpy as np


def result_of_search(
    request: Request,
    best: Attempt,
    first: FirstSolution | None,
    work: Work,
    budget: Budget,
    began: float,
) -> PlanResult:
    """
    Return the result of a request whose ``best`` attempt is given.

    ``first`` is the first path as found, None where there is none, and ``work`` that of all
    searches. ``began`` is the time at which the call began, on the clock of ``working_time`` [s].
    """
    length = path_length(best.path) if len(best.path) else math.inf
    samples = request.space.from_kernel(best.search.samples)
    samples[0] = request.start
    return PlanResult(
        status=best.status,
        message=_message(request, best, length, work.iterations, began),
        planner=best.planner,
        path=best.path,
        length=length,
        samples=samples,
        parents=best.search.parents.copy(),
        iterations=work.iterations,
        counts=work.counts,
        elapsed=working_time() - began,
        seed=request.seed,
        cut_by_time=budget.cut,
        first_solution=first,
        lower_bound=best.lower_bound,
        clear_lower_bound=best.kept_clear.lower_bound,
    )


def result_without_search(
    request: Request, status: PlannerStatus, message: str, budget: Budget, began: float
) -> PlanResult:
    """
    Return the result of a request whose outcome, ``status`` and ``message``, needs no search.

    ``began`` is the time at which the call began, on the clock of ``working_time`` [s].
    """
    if status is PlannerStatus.SOLVED:
        return _result_at_once(request, message, budget, began)
    proved = status not in (PlannerStatus.TIMEOUT, PlannerStatus.CANCELLED)
    return PlanResult.without_search(
        status,
        message,
        planner=request.planner.name,
        dim=len(request.start),
        seed=request.seed,
        elapsed=working_time() - began,
        cut_by_time=budget.cut,
        lower_bound=math.inf if proved else request.straight_length,
    )


def _result_at_once(request: Request, message: str, budget: Budget, began: float) -> PlanResult:
    """
    Return the result of a request whose start reaches the goal directly.

    The path is the straight segment to an exact goal, or the start twice where the goal has a
    radius, moved away from walls where a clearance is requested.
    """
    end = request.goal if request.goal_radius == 0.0 else request.start
    straight = np.array((request.start, end))
    first = FirstSolution(working_time() - began, path_length(straight), straight)
    path = with_clearance(request, straight, budget)
    return PlanResult(
        status=PlannerStatus.SOLVED,
        message=message,
        planner=request.planner.name,
        path=path,
        length=path_length(path),
        samples=path[:1].copy(),
        parents=np.array([NONE], dtype=np.int64),
        iterations=0,
        counts={},
        elapsed=working_time() - began,
        seed=request.seed,
        cut_by_time=budget.cut,
        first_solution=first,
        lower_bound=request.straight_length,
    )


def _message(request: Request, best: Attempt, length: float, iterations: int, began: float) -> str:
    """
    Return a description of how the search of ``best`` ended.

    It states ``length`` [m], that of the path, and ``iterations``, those of all searches.
    """
    if best.status is PlannerStatus.SOLVED and best.first is not None:
        found = f'path of {length:.6g} m with {len(best.path)} vertices'
        as_found = request.simplify and not best.search.taut and best.path is best.first.path
        nothing = ', of which no shortcut is free' if as_found and len(best.path) > 2 else ''
        proved = proof(length, best.lower_bound, request.straight_length) + proof_of_clearance(
            request.clearance, best.keeps_clearance, length, best.kept_clear.lower_bound
        )
        return f'{found} after {iterations} transitions{nothing}{proved}'
    seconds = working_time() - began
    return f'{best.status.value} ({iterations} transitions, {seconds:.3g} s)'
