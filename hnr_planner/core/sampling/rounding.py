"""
Rounding: coordinates in which a set is about as long in all directions.

A walk takes the longer, the more the lengths of a set differ between directions. A polytope is
rounded by the ellipsoid of its logarithmic barrier, which lies inside and, enlarged, holds all
points; every set by the covariance of draws, in phases, until that covariance is about the same in
all directions. Each phase draws in the coordinates of the phase before. A walk that is slow at
first shows a part of the longest directions only, and more of them in each phase.

The covariance of few draws is longer in some directions than in others even where the set is not:
to change the coordinates by it would make them worse. So a phase that looks but a little long is
repeated with twice the draws, until it looks round or more draws make no difference.
"""

import time
from typing import Any

from hnr_planner.core.checks import check_point, check_seed, Floats, Seed
from hnr_planner.core.errors import RequestError
from hnr_planner.core.sampling.chains import begin_chains, walk_on
from hnr_planner.core.sampling.walks import CoordinateHitAndRunWalk, HitAndRunWalk
from hnr_planner.core.spaces.polytope.extent import inner_ellipsoid
from hnr_planner.core.spaces.polytope.polytope_space import PolytopeSpace
from hnr_planner.core.spaces.rounded import RoundedSpace, Rounding
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike

#: Draws of a phase and steps between two of them, for each dimension.
DRAWS, THIN = 12, 2
#: Least number of draws of a phase.
DRAWS_MIN = 200
#: Ratio of standard deviations up to which a set is round; that of as many independent draws of a
#: round set is about 1.8.
ROUND = 2.5
#: Ratio of standard deviations up to which a phase may look long for want of independent draws.
DOUBTFUL = 10.0
#: Ratio of a repeated phase over the ratio before, from which on more draws make no difference.
SETTLED = 0.8
#: Largest number of phases.
PHASES_MAX = 40
#: Smallest standard deviation that a phase takes for real, as a fraction of the largest.
LEAST = 1e-4


def round_space(
    space: Space, start: ArrayLike | None = None, *, seed: Seed = None
) -> RoundedSpace:
    """
    Return the same set in coordinates in which it is about as long in all directions.

    Draws of the result are points of the caller's frame. ``begin_chains``, ``walk_on`` and
    ``sample`` take it like ``space``. In a polytope, ``CoordinateHitAndRunWalk`` then moves along
    the normals of facets, and is the fastest walk with ``overrelaxed=True``.

    Parameters
    ----------
    space : Space
        The set; connected, or only the component of the start is measured.
    start : (dim,), optional
        A free point, caller's frame. A polytope needs none.
    seed : int, numpy.random.SeedSequence, numpy.random.Generator or None
        Source of the random numbers; fresh when left out.

    Raises
    ------
    RequestError
        When the start is missing or not free.
    StuckError
        When a chain does not move.

    """
    began, seed = time.process_time(), check_seed(seed)
    if start is None and not isinstance(space, PolytopeSpace):
        raise RequestError(f'start must be given for a {type(space).__name__}')
    at = None if start is None else check_point('start', start, space.dim)
    if at is not None and not space.contains(at):
        raise RequestError(f'start {at.tolist()} is {space.why_not_free(at)}')
    matrix, origin, walk = _first_map(space, at)
    dim, steps, phase = space.kernel_dim, 0, 0
    n_draws = max(DRAWS_MIN, DRAWS * dim)
    rounded = RoundedSpace(space, matrix, origin)
    ratio = 1.0
    # The ratio that the last phase has found in the present coordinates; infinite in the first.
    before = np.inf
    while dim > 1 and phase < PHASES_MAX:
        chains = begin_chains(rounded, space.from_kernel(origin), seed=_seed_of(seed, phase))
        draws, chains = walk_on(rounded, chains, n_draws, walk=walk, thin=THIN * dim)
        steps, phase = steps + int(chains.steps[0]), phase + 1
        spread, axes = _principal_axes(rounded.to_kernel(draws[0]))
        ratio = float(spread[-1] / spread[0])
        if ratio <= ROUND:
            break
        if ratio <= DOUBTFUL and ratio < SETTLED * before:
            n_draws, before = 2 * n_draws, ratio
            continue
        matrix = matrix @ (axes * np.maximum(spread, LEAST * spread[-1])) @ axes.T
        rounded, before = RoundedSpace(space, matrix, origin), np.inf
    cost = Rounding(phase, steps, time.process_time() - began, ratio)
    return RoundedSpace(space, matrix, origin, cost)


def _first_map(space: Space, start: Floats | None) -> tuple[Floats, Floats, Any]:
    """Return a first matrix, a free point in the kernel frame, and the walk of the phases."""
    if isinstance(space, PolytopeSpace):
        centre = space.analytic_centre
        matrix = inner_ellipsoid(space.data.normals, space.data.offsets, centre)
        return matrix, centre, CoordinateHitAndRunWalk(overrelaxed=True)
    lower, upper = space.kernel_bounds
    return np.diag((upper - lower) / 2.0), space.to_kernel(np.asarray(start)), HitAndRunWalk()


def _principal_axes(draws: Floats) -> tuple[Floats, Floats]:
    """Return the standard deviations (k,) of draws (n, k), ascending, and their axes."""
    values, axes = np.linalg.eigh(np.cov(draws.T))
    return np.sqrt(np.maximum(values, np.finfo(np.float64).tiny)), axes


def _seed_of(seed: int, phase: int) -> np.random.SeedSequence:
    """Return the seed of the chain of a phase."""
    return np.random.SeedSequence(seed, spawn_key=(phase,))
