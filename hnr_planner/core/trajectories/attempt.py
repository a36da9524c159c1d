"""
One search for a trajectory: the motion found is converted, checked and shortened.

A search ends with a motion in the kernel frame. The motion is converted to a trajectory in the
caller's frame, every step of the trajectory is checked, and the motion is shortened if the request
asks for that. Each of these stages stops when the budget ends, as the search does: a chain of
Hit-and-Run may have hundreds of thousands of steps.
"""

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

from hnr_planner.core.errors import Interrupted
from hnr_planner.core.kernels.clock import working_time
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.planning.attempts import SEARCH, SHORTEN
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.request import Effort
from hnr_planner.core.planning.restarts import search_until_free
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus
from hnr_planner.core.systems.primitives import first_blocked_step
from hnr_planner.core.systems.trajectory import Trajectory
from hnr_planner.core.trajectories.problem import KinodynamicSearch, Motion
from hnr_planner.core.trajectories.reduce import reduce, STEPS_MAX
from hnr_planner.core.trajectories.request import KinodynamicRequest
from hnr_planner.core.trajectories.shorten import shorten
import numpy as np

#: Purpose of the random stream that reduces a long motion, beside those of all attempts.
REDUCE = 2
#: Proposals for a shorter motion: for every request, for each of ``optimize_iterations``, and
#: between two checks of the budget.
PROPOSALS, PROPOSALS_AGAIN, PROPOSALS_IN_A_BATCH = 2000, 10000, 200
#: States handled between two checks of the budget: all those of a trajectory of normal length.
CHUNK = STEPS_MAX + 1


class Found(NamedTuple):
    """
    The motion that a search found, and the trajectory made of it.

    Attributes
    ----------
    motion : Motion
        The motion from which shortening starts, in the kernel frame.
    trajectory : Trajectory or None
        The motion in the caller's frame, free; None where the motion has more than ``STEPS_MAX``
        steps and the request does not accept any length.
    first : FirstSolution
        Time, length and positions of the trajectory as found, before any shortening.

    """

    motion: Motion
    trajectory: Trajectory | None
    first: FirstSolution


def search_trajectory(
    request: KinodynamicRequest, budget: Budget, began: float
) -> tuple[PlannerStatus, KinodynamicSearch, Found | None]:
    """
    Search until a motion is free in the caller's frame too, or a limit ends the search.

    Returns (status, the last search, what it found or None). ``began`` is the time at which the
    request began, on the clock of ``working_time`` [s].
    """

    def start(salt: int) -> KinodynamicSearch:
        return request.planner.start(request.problem, request.geometric.stream(0, SEARCH, salt))

    def found_by(search: KinodynamicSearch) -> Found | None:
        return budget.within(lambda: evaluate(request, search, budget, began), None)

    return search_until_free(start, found_by, budget)


def evaluate(
    request: KinodynamicRequest, search: KinodynamicSearch, budget: Budget, began: float
) -> Found | None:
    """
    Return what a solved search found; None if the trajectory meets the boundary.

    A motion of more than ``STEPS_MAX`` steps is reduced where the request shortens. If it is
    still too long, and the request does not accept any length, the trajectory is None and is not
    checked.

    Raises
    ------
    Interrupted
        When the budget ends before a long motion is converted and checked.

    """
    elapsed = working_time() - began
    as_found = search.motion
    trajectory = to_trajectory(request, as_found, budget)
    first = FirstSolution(elapsed, _length(trajectory, budget), trajectory.positions)
    motion = search.draft(as_found) if request.shortens else as_found
    if len(motion.durations) > STEPS_MAX and request.shortens:
        motion = reduce(request.problem, motion, request.geometric.stream(0, REDUCE), budget)
    if len(motion.durations) > STEPS_MAX and not request.any_length:
        return Found(motion, None, first)
    if motion is not as_found:
        trajectory = to_trajectory(request, motion, budget)
    return Found(motion, trajectory, first) if is_free(request, trajectory, budget) else None


def shortened(
    request: KinodynamicRequest,
    motion: Motion,
    trajectory: Trajectory,
    effort: Effort,
    budget: Budget,
    began: float,
) -> Trajectory:
    """
    Return a trajectory of no longer duration, shortened until proposals or budget end.

    If the result meets the boundary in the caller's frame, or the budget ends before that check,
    ``trajectory`` itself is returned.
    """
    rng = request.geometric.stream(0, SHORTEN)
    motion = _shorten_within(request, motion, rng, PROPOSALS, budget)
    if effort.optimizes:
        optimizing = effort.optimizing(budget, began)
        proposals = PROPOSALS_AGAIN * effort.optimize_rounds
        motion = _shorten_within(request, motion, rng, proposals, optimizing)
        budget.cut = budget.cut or optimizing.cut
    shorter = to_trajectory(request, motion, budget)
    free = budget.within(lambda: is_free(request, shorter, budget), False)
    return shorter if free else trajectory


def _shorten_within(
    request: KinodynamicRequest, motion: Motion, rng: Stream, proposals: float, budget: Budget
) -> Motion:
    """Return the motion after ``proposals`` attempts to shorten it, fewer if the budget ends."""
    brakes = request.planner.boundary == 'forbidden'
    while proposals > 0 and budget.stop() is None:
        batch = int(min(proposals, PROPOSALS_IN_A_BATCH))
        work = partial(shorten, request.problem, motion, rng, batch, brakes)
        motion = budget.within(work, motion)
        proposals -= batch
    return motion


def to_trajectory(request: KinodynamicRequest, motion: Motion, budget: Budget) -> Trajectory:
    """
    Return the trajectory in the caller's frame of a motion in the kernel frame.

    The first state is exactly the caller's start. If the motion ends exactly at the goal, the last
    position is exactly the caller's goal. Raises Interrupted when the budget ends.
    """
    system, space = request.system, request.geometric.space
    states, controls = np.empty_like(motion.states), np.empty_like(motion.controls)
    for rows in _chunks(len(states), budget):
        states[rows] = system.from_kernel(space, motion.states[rows])
        controls[rows] = system.controls_from_kernel(space, motion.controls[rows])
    states[0] = request.start
    if motion.states[-1, : system.dim].tolist() == request.problem.geometric.goal.tolist():
        states[-1, : system.dim] = request.geometric.goal
    return Trajectory(system, np.append(0.0, np.cumsum(motion.durations)), states, controls)


def is_free(request: KinodynamicRequest, trajectory: Trajectory, budget: Budget) -> bool:
    """Return whether no step of a trajectory meets the boundary; raise Interrupted at a limit."""
    system, space, durations = request.system, request.geometric.space, np.diff(trajectory.times)
    for rows in _chunks(len(durations), budget):
        step = first_blocked_step(
            request.problem.system,
            space.data,
            system.to_kernel(space, trajectory.states[rows]),
            system.controls_to_kernel(space, trajectory.controls[rows]),
            durations[rows],
        )
        if step >= 0:
            return False
    return True


def _length(trajectory: Trajectory, budget: Budget) -> float:
    """Return the length [m] of a trajectory; raise Interrupted at a limit of the budget."""
    durations, total = np.diff(trajectory.times), 0.0
    for rows in _chunks(len(durations), budget):
        steps = trajectory.states[rows], trajectory.controls[rows], durations[rows]
        total += float(trajectory.system.lengths(*steps).sum())
    return total


def _chunks(n_rows: int, budget: Budget) -> Iterator[slice]:
    """
    Yield slices of at most ``CHUNK`` rows that cover ``n_rows`` rows.

    Before every slice except the first, raise Interrupted if the budget has ended.
    """
    for first in range(0, n_rows, CHUNK):
        if first > 0 and budget.stop() is not None:
            raise Interrupted('the work was interrupted before it was done')
        yield slice(first, min(first + CHUNK, n_rows))
