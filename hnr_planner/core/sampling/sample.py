"""Uniform points of a space, by chains of a random walk."""

from concurrent.futures import ThreadPoolExecutor

from hnr_planner.core.borrowed import borrowed
from hnr_planner.core.checks import (
    check_choice,
    check_count,
    check_point,
    check_seed,
    Floats,
)
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels import kernel
from hnr_planner.core.sampling.walks import coordinate_hit_and_run_step, hit_and_run_step
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.streams import stream
import numpy as np
from numpy.typing import ArrayLike

#: Names of the walks; a kernel knows each by its place here.
WALKS = ('hit_and_run', 'coordinate_hit_and_run')


def sample(
    space: Space,
    start: ArrayLike,
    n_draws: int,
    *,
    walk: str = 'hit_and_run',
    n_chains: int = 1,
    burn_in: int = 0,
    thin: int = 1,
    seed: int | None = None,
) -> Floats:
    """
    Draw points that are uniform on the start's connected part of a space, in the long run.

    Every chain walks from ``start`` in a thread and with a random stream of its own: the draws are
    the same whatever the number of processors.

    Parameters
    ----------
    space : Space
        The set to draw from.
    start : (dim,)
        A free point.
    n_draws : int
        Points kept of each chain.
    walk : 'hit_and_run' or 'coordinate_hit_and_run'
        The step: a uniform direction, or one of the axes, and a uniform point on the chord.
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
        When an argument is malformed, or the start is not free.

    """
    start = check_point('start', start, space.dim)
    n_draws = check_count('n_draws', n_draws, 0)
    n_chains = check_count('n_chains', n_chains, 1)
    burn_in = check_count('burn_in', burn_in, 0)
    thin = check_count('thin', thin, 1)
    step = WALKS.index(check_choice('walk', walk, WALKS))
    if not space.contains(start):
        raise RequestError(f'start {start.tolist()} is {space.why_not_free(start)}')

    draws = np.empty((n_chains, n_draws, space.dim))
    seed = check_seed(seed)

    def walk_chain(chain: int) -> None:
        x, rng = space.to_kernel(start), stream(seed, chain)
        run_chain(space.data, step, x, rng, burn_in, thin, draws[chain])

    with ThreadPoolExecutor() as pool:
        list(pool.map(walk_chain, range(n_chains)))
    return space.from_kernel(draws)


@kernel
def run_chain(space, step, x, rng, burn_in, thin, draws):
    """Walk on from ``x`` (dim,), which is moved along, and fill ``draws`` (n_draws, dim)."""
    space, x, rng = borrowed(space), borrowed(x), borrowed(rng)
    y = np.empty_like(x)
    for _ in range(burn_in):
        _take_step(space, step, x, rng, y)
    for k in range(len(draws)):
        for _ in range(thin):
            _take_step(space, step, x, rng, y)
        draws[k] = x


@kernel
def _take_step(space, step, x, rng, y):
    if step == 0:
        hit_and_run_step(space, x, rng, y)
    else:
        coordinate_hit_and_run_step(space, x, rng, y)
    x[:] = y
