"""
``plan``: one request, one answer.

The planners search and count; ``plan`` alone checks the request, owns the clock, listens for a
cancellation and says in words how it ended.
"""

from dataclasses import replace
import math
import time
from typing import Any

from hnr_planner.core.cancellation import Event
from hnr_planner.core.checks import check_count, check_number
from hnr_planner.core.errors import RequestError
from hnr_planner.core.lengths import path_length
from hnr_planner.core.planning.alternatives.alternatives import (
    check_alternatives,
    compile_alternatives,
    with_alternatives,
)
from hnr_planner.core.planning.attempts import Attempt, attempt, improve, with_clearance
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.planner import compile_search, Planner
from hnr_planner.core.planning.postprocessing.clearance import compile_clearance
from hnr_planner.core.planning.postprocessing.simplify import compile_shorten
from hnr_planner.core.planning.request import check_request, outcome_without_search, Request
from hnr_planner.core.planning.result import (
    FirstSolution,
    PlannerStatus,
    PlanResult,
)
from hnr_planner.core.spaces.primitives import kind_of
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.systems.system import System
from hnr_planner.core.trajectories.plan_trajectory import check_kinodynamic_request, plan_motion
import numpy as np
from numpy.typing import ArrayLike


def plan(
    space: Space,
    start: ArrayLike,
    goal: ArrayLike,
    *,
    algorithm: str | Planner = 'auto',
    goal_radius: float = 0.0,
    time_limit: float = 1.0,
    max_iterations: int | None = None,
    seed: int | None = None,
    simplify: bool = True,
    optimize_for: float = 0.0,
    optimize_iterations: int = 0,
    alternatives: int = 1,
    system: System | None = None,
    goal_speed: float = math.inf,
    cancel: Event | None = None,
    **settings: Any,
) -> PlanResult:
    """
    Find a free path.

    Parameters
    ----------
    space : Space
        Where the path has to be free.
    start, goal : (dim,)
        Points in the caller's frame [m].
    algorithm : str or planner
        A name of ``ALGORITHMS`` or a planner value such as ``RRT(max_step=0.5)``.
    goal_radius : float
        Above 0 the path ends within this distance [m] of the goal (the paper's goal region): at
        the first sample there, or where a tree that grew from the goal began. At 0 it ends exactly
        at the goal, as soon as a sample sees it.
    time_limit : float
        Seconds for the whole call, inf for no limit. Compilation does not count.
    max_iterations : int, optional
        Transitions allowed for one search.
    seed : int, optional
        Fresh when left out; the result names the one used.
    simplify : bool
        Whether the path is shortened by visibility.
    optimize_for : float
        For so many seconds of the call, within the time limit, a shorter path is looked for again
        and again; a straight one ends it.
    optimize_iterations : int
        How many more searches to run for a shorter path; together with ``optimize_for`` whichever
        ends first.
    alternatives : int
        How many paths to look for, none of which can be deformed into another past an obstacle:
        ``PlanResult.paths``, the shortest first. There may be fewer. All have the same ends, also
        in a goal region.
    system : System, optional
        What moves, where that is a robot with inertia: then ``start`` is a state of it, the
        answer has a trajectory, and ``algorithm`` is one of ``KINODYNAMIC_ALGORITHMS``.
        ``simplify``, ``optimize_for`` and ``optimize_iterations`` shorten its duration.
    goal_speed : float
        Largest speed at the goal [m/s], for a system.
    cancel : threading.Event, optional
        Ends the call once it is set.
    **settings
        Settings of the planner that ``algorithm`` names.

    Returns
    -------
    PlanResult
        Not finding a path is a status, never an exception.

    Raises
    ------
    RequestError
        When an argument is malformed; the message names the value and the rule.

    """
    seconds = check_number('time_limit', time_limit, 0.0)
    improve_seconds = check_number('optimize_for', optimize_for, 0.0)
    improve_searches = check_count('optimize_iterations', optimize_iterations, 0)
    transitions = (
        math.inf if max_iterations is None else check_count('max_iterations', max_iterations, 1)
    )
    if system is not None:
        _check_for_system(alternatives)
        motion = check_kinodynamic_request(
            space,
            start,
            goal,
            system,
            algorithm=algorithm,
            settings=settings,
            goal_radius=goal_radius,
            goal_speed=goal_speed,
            simplify=simplify,
            seed=seed,
        )
        return plan_motion(motion, seconds, transitions, improve_seconds, improve_searches, cancel)
    if goal_speed != math.inf:
        raise RequestError(f'goal_speed goes with a system only, got {goal_speed!r}')
    request = check_request(space, start, goal, goal_radius, algorithm, settings, simplify, seed)
    n_paths = check_alternatives(space, alternatives, request.simplify)
    _compile(request, n_paths)

    began = time.perf_counter()
    limits = Budget(began + seconds, transitions, cancel)
    known = outcome_without_search(request)
    if known is not None:
        answer = _answer_without_search(request, *known, limits, began)
    else:
        answer = _answer_by_search(request, limits, improve_seconds, improve_searches, began)
    if n_paths > 1 and answer.status is PlannerStatus.SOLVED:
        answer = with_alternatives(request, answer, n_paths, limits, began)
    return answer


def _check_for_system(alternatives: int) -> None:
    if check_count('alternatives', alternatives, 1) > 1:
        raise RequestError(f'alternatives must be 1 for a system, got {alternatives}')


def _answer_by_search(
    request: Request, limits: Budget, improve_seconds: float, improve_searches: int, began: float
) -> PlanResult:
    """Search, and search again for a shorter path where that is asked for."""
    improving = None
    if improve_seconds or improve_searches:
        until = began + (improve_seconds or math.inf)
        improving = replace(limits, deadline=min(limits.deadline, until))
    best = attempt(request, 0, limits, began, improving)
    first, iterations = best.first, best.search.iterations
    if first is not None and improving is not None:
        best, iterations = improve(request, best, improve_searches or math.inf, improving, began)
        limits.cut = limits.cut or improving.cut
    samples = request.space.from_kernel(best.search.samples)
    samples[0] = request.start
    return PlanResult(
        status=best.status,
        message=_message(best, iterations, began),
        planner=request.planner.name,
        path=best.path,
        length=path_length(best.path) if len(best.path) else math.inf,
        samples=samples,
        parents=best.search.parents.copy(),
        iterations=iterations,
        counts=best.search.counts,
        elapsed=time.perf_counter() - began,
        seed=request.seed,
        cut_by_time=limits.cut,
        first_solution=first,
    )


def _answer_without_search(
    request: Request, status: PlannerStatus, message: str, limits: Budget, began: float
) -> PlanResult:
    """Answer a request that needs no search to fail or to succeed."""
    path, length, samples, first = np.empty((0, len(request.start))), math.inf, 0, None
    if status is PlannerStatus.SOLVED:
        end = request.goal if request.goal_radius == 0.0 else request.start
        path, samples = np.stack([request.start, end]), 1
        first = FirstSolution(time.perf_counter() - began, path_length(path))
        path = with_clearance(request, path, limits)
        length = path_length(path)
    return PlanResult(
        status=status,
        message=message,
        planner=request.planner.name,
        path=path,
        length=length,
        samples=path[:samples].copy(),
        parents=np.full(samples, -1),
        iterations=0,
        counts={},
        elapsed=time.perf_counter() - began,
        seed=request.seed,
        cut_by_time=limits.cut,
        first_solution=first,
    )


def _message(best: Attempt, iterations: int, began: float) -> str:
    """Say in words how a search ended."""
    if best.status is PlannerStatus.SOLVED:
        found = f'path of {path_length(best.path):.6g} m with {len(best.path)} vertices'
        return f'{found} after {iterations} transitions'
    seconds = time.perf_counter() - began
    return f'{best.status.value} ({iterations} transitions, {seconds:.3g} s)'


_compiled: set[tuple[tuple[Any, ...], type[Planner], bool, bool]] = set()


def _compile(request: Request, n_paths: int) -> None:
    """Compile, once for each kind of space and planner, before any clock runs."""
    space = request.space
    kinds = kind_of(space.data), type(request.planner), n_paths > 1, request.clearance > 0.0
    if kinds in _compiled:
        return
    compile_search(request.planner, request.problem)
    outcome_without_search(request)
    ends = np.stack([request.start, request.start])
    compile_shorten(space, ends)
    space.first_blocked_segment(ends)
    space.rough_path(request.problem.start, request.problem.start)
    if n_paths > 1:
        compile_alternatives(request)
    if request.clearance > 0.0:
        compile_clearance(space, ends, request.clearance)
    _compiled.add(kinds)
