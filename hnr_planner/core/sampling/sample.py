"""Uniform points of a space, by chains of a random walk."""

from hnr_planner.core.checks import check_count, Floats
from hnr_planner.core.sampling.chains import begin_chains, walk_on
from hnr_planner.core.sampling.walks import Walk
from hnr_planner.core.spaces.space import Space
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
    seed: int | None = None,
) -> Floats:
    """
    Draw points that are uniform on the start's connected part of a space, in the long run.

    Every chain walks in a thread and with a random stream of its own: the draws are the same
    whatever the number of processors. ``begin_chains`` and ``walk_on`` do the same in parts, and
    tell what was counted.

    Parameters
    ----------
    space : Space
        The set to draw from.
    start : (dim,) or (n_chains, dim)
        A free point where all chains begin, or one for each.
    n_draws : int
        Points kept of each chain.
    walk : 'hit_and_run', 'coordinate_hit_and_run', 'ball_walk' or a walk
        How to step; a walk with settings is a value: ``BallWalk(radius=0.1)``.
    n_chains : int
        Independent chains.
    burn_in : int
        Steps at the beginning of each chain that are not kept.
    thin : int
        One point is kept of every ``thin`` steps.
    seed : int, optional
        Fresh when left out.

    Returns
    -------
    (n_chains, n_draws, dim) float64
        Points in the caller's frame.

    Raises
    ------
    RequestError
        When an argument is malformed, or a start is not free.
    StuckError
        When a chain does not move any more.

    """
    burn_in = check_count('burn_in', burn_in, 0)
    chains = begin_chains(space, start, n_chains=n_chains, seed=seed)
    if burn_in > 0:
        _, chains = walk_on(space, chains, 1, walk=walk, thin=burn_in)
    draws, _ = walk_on(space, chains, n_draws, walk=walk, thin=thin)
    return draws
