"""Draw uniform points of a space by Hit-and-Run steps; update them after a change of the space."""

from hnr_planner.core.cancellation import Event, in_chunks
from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.copies import copy_into
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.planning.planners.rrt import draw_in_box
from hnr_planner.core.planning.roadmap.data import RoadmapData
from hnr_planner.core.sampling.draws import hit_and_run_step
from hnr_planner.core.spaces.primitives import are_free, contains
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import NDArray

#: Number of uniform proposals for each starting point, and of Hit-and-Run steps from a starting
#: point to a draw.
PROPOSALS, STEPS = 64, 8
#: Purposes of random streams: starting points, walks.
ROOTS, WALK = 0, 1


def draw_slots(
    before: RoadmapData, space: Space, n_draws: int, seed: int, cancel: Event | None
) -> tuple[Floats, NDArray[np.bool_]]:
    """
    Return a uniform draw for each slot (k, dim), and which of the draws were kept (k,) bool.

    A new draw is made for each slot. A slot keeps its old draw, unless that is not free any more
    or the new draw was not free before: so draws that were uniform on the old space are uniform on
    the new one. Where no free point is found, no slot has a draw (k = 0).
    """
    roots = np.empty((n_draws, space.dim))
    n_roots = _free_points(
        space.data, *space.kernel_bounds, stream(seed, ROOTS, before.age), PROPOSALS, roots
    )
    n_filled = n_draws if n_roots > 0 else 0
    draws, stays = (
        np.resize(roots[:n_roots], (n_filled, space.dim)),
        np.zeros(n_filled, dtype=bool),
    )
    for chunk in in_chunks(n_filled, cancel):
        _walk(space.data, stream(seed, WALK, before.age, chunk.start), STEPS, draws[chunk])
    old = before.draws[:n_filled]
    stays[: len(old)] = space is before.space or (
        are_free(space.data, old) & are_free(before.space.data, draws[: len(old)])
    )
    draws[stays] = before.draws[:n_filled][stays[: len(old)]]
    return draws, stays


@kernel
def _free_points(space, lower, upper, rng, proposals, points):
    """
    Write free points, uniform in free space, to ``points`` (k, dim); return their number.

    They are fewer than k where ``proposals`` for each point do not yield enough.
    """
    n = 0
    for _ in range(proposals * len(points)):
        if n == len(points):
            break
        draw_in_box(lower, upper, rng, points[n])
        if contains(space, points[n]):
            n += 1
    return n


@kernel
def _walk(space, rng, steps, points):
    """Move each of ``points`` (k, dim), in place, by ``steps`` Hit-and-Run steps."""
    space, rng, points = borrowed(space), borrowed(rng), borrowed(points)
    y = np.empty(points.shape[1])
    for k in range(len(points)):
        for _ in range(steps):
            hit_and_run_step(space, points[k], rng, y)
            copy_into(points[k], y)
