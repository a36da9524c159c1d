"""Uniform points of a space, by chains of a random walk."""

from hnr_planner.core.checks import check_count, Floats, Seed
from hnr_planner.core.kernels.modes import in_this_mode
from hnr_planner.core.sampling.chains import begin_chains, Chains, walk_on
from hnr_planner.core.sampling.walks import Walk
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike


def sample(
    space: Space,
    start: ArrayLike,
    n_draws: int,
    *,
    walk: str | Walk = 'hit_and_run',
    n_chains: int = 1,
    burn_in: int = 0,
    thin: int = 1,
    seed: Seed = None,
    n_jobs: int | None = None,
) -> Floats:
    """
    Return points of a random walk whose limit is the uniform distribution on its component.

    For ``walk=HitAndRunWalk(log_density=...)`` the limit is that density on the component.

    A chain stays in the connected component of its start. Every chain has its own random stream,
    so that the draws do not depend on the number of processors. ``begin_chains`` and ``walk_on``
    give the same draws in several runs, with counts of steps and moves.

    Parameters
    ----------
    space : Space
        The set to draw from.
    start : (dim,) or (n_chains, dim)
        One free point for all chains, or one for each chain, in the caller's frame.
    n_draws : int
        Number of points kept of each chain.
    walk : 'hit_and_run', 'coordinate_hit_and_run', 'ball_walk' or a walk
        The random walk; one with settings is a value: ``BallWalk(radius=0.1)``.
    n_chains : int
        Number of independent chains; may be left out when ``start`` has a row for each chain.
    burn_in : int
        Steps at the beginning of each chain that are not kept.
    thin : int
        Number of steps for each point kept: the point after the last of these steps.
    seed : int, numpy.random.SeedSequence, numpy.random.Generator or None
        Fresh when left out. A generator is advanced, so that the next call gives other draws.
    n_jobs : int, optional
        Number of jobs among which joblib shares out the chains, -1 for one on each processor; the
        draws are the same for any number. The back end (processes, a Dask cluster) is that of
        ``joblib.parallel_config``, and space and walk have to be such that it can pickle them;
        functions in them may be lambdas.
        When left out, the chains run in threads of this process.

    Returns
    -------
    (n_chains, n_draws, dim) float64
        Points in the caller's frame.

    Raises
    ------
    RequestError
        When an argument is malformed, or a start is not free.
    StuckError
        When a chain has not moved for 1000 consecutive steps.
    ModuleNotFoundError
        When ``n_jobs`` is given, and joblib is not installed.

    """
    burn_in = check_count('burn_in', burn_in, 0)
    chains = begin_chains(space, start, n_chains=n_chains, seed=seed)
    n_draws, thin = check_count('n_draws', n_draws, 0), check_count('thin', thin, 1)
    if n_jobs is None:
        return _draw(space, chains, n_draws, walk, burn_in, thin)
    from joblib import delayed, Parallel

    parts = Parallel(n_jobs=n_jobs)(
        delayed(in_this_mode(_draw))(space, chains.one(k), n_draws, walk, burn_in, thin)
        for k in range(len(chains.points))
    )
    return np.concatenate(parts)


def _draw(
    space: Space, chains: Chains, n_draws: int, walk: str | Walk, burn_in: int, thin: int
) -> Floats:
    """Return the draws (n_chains, n_draws, dim) of chains after ``burn_in`` steps."""
    if burn_in > 0:
        _, chains = walk_on(space, chains, 1, walk=walk, thin=burn_in)
    draws, _ = walk_on(space, chains, n_draws, walk=walk, thin=thin)
    return draws
