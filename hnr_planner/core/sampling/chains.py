"""
Chains: runs of a random walk that can be stopped, saved and resumed.

The state of a chain is its point, its random stream, the numbers that the space caches for the
point, and counters of its steps.
``begin_chains`` makes the states; ``walk_on`` is a pure function from states to draws and new
states, so that two runs of half the length equal one long run to the last bit. States are arrays
only, and can be saved to a file:

>>> np.savez('chains.npz', **vars(chains))
>>> chains = Chains(**np.load('chains.npz'))
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from hnr_planner.core.checks import check_count, check_points, check_seed, Floats, Seed
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.modes import in_this_mode
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.sampling.chain import Chain, new_chain, run_chain
from hnr_planner.core.sampling.steps import MOVES, N_COUNTS, REDRAWS, STEPS, ZERO_CHORDS
from hnr_planner.core.sampling.walks import make_walk, Walk
from hnr_planner.core.spaces.chain_cache import memory_size
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True, eq=False)
class Chains:
    """
    States of several chains between two steps, valid in the space they were begun in alone.

    Attributes
    ----------
    points : (n_chains, dim)
        Positions in the space's kernel frame.
    memory : (n_chains, k)
        Numbers that the space caches for the position of each chain; k depends on the space.
    streams : (n_chains, 4) uint64
        State of the random stream of each chain.
    counts : (n_chains, 5) int64
        Counters: steps, moves, zero chords, redraws, and steps since the last move.

    """

    points: Floats
    memory: Floats
    streams: NDArray[np.uint64]
    counts: NDArray[np.int64]

    def chain(self, k: int) -> Chain:
        """Return the state of chain ``k`` as views of these arrays, not copies."""
        return Chain(self.points[k], self.memory[k], self.streams[k], self.counts[k])

    def one(self, k: int) -> 'Chains':
        """Return chain ``k`` alone, as views of these arrays, not copies."""
        rows = slice(k, k + 1)
        return Chains(*(array[rows] for array in vars(self).values()))

    @property
    def steps(self) -> NDArray[np.int64]:
        """Number of steps that each chain has taken since it was begun: (n_chains,)."""
        return self.counts[:, STEPS]

    @property
    def moves(self) -> NDArray[np.int64]:
        """Number of steps that moved each chain (n_chains,); of a ball walk, those accepted."""
        return self.counts[:, MOVES]

    @property
    def zero_chords(self) -> NDArray[np.int64]:
        """Number of steps of each chain (n_chains,) on a chord shorter than the zero length."""
        return self.counts[:, ZERO_CHORDS]

    @property
    def redraws(self) -> NDArray[np.int64]:
        """Number of draws of each chain (n_chains,) repeated for rounding onto the boundary."""
        return self.counts[:, REDRAWS]


def begin_chains(
    space: Space, start: ArrayLike, *, n_chains: int = 1, seed: Seed = None
) -> Chains:
    """
    Return chains at their starts, before the first step, each with its own random stream.

    Parameters
    ----------
    space : Space
        The set to draw from.
    start : (dim,) or (n_chains, dim)
        One free point for all chains, or one for each chain, in the caller's frame.
    n_chains : int
        Number of independent chains; may be left out when ``start`` has a row for each chain.
    seed : int, numpy.random.SeedSequence, numpy.random.Generator or None
        Source of the random streams; a fresh seed is drawn when left out. A generator is
        advanced. Chain k has the same stream for every ``n_chains`` > k.

    Raises
    ------
    RequestError
        When an argument is malformed, or a start is not free.

    """
    starts = np.atleast_2d(_check_starts(space, start))
    n_chains, seed = check_count('n_chains', n_chains, 1), check_seed(seed)
    if len(starts) == 1:
        starts = np.repeat(starts, n_chains, axis=0)
    elif n_chains not in (1, len(starts)):
        raise RequestError(f'{n_chains} chains need one start, or as many, got {len(starts)}')
    points = space.to_kernel(starts)
    each = [new_chain(space, x, stream(seed, k)) for k, x in enumerate(points)]
    return Chains(*map(np.stack, zip(*each, strict=True)))


def walk_on(
    space: Space,
    chains: Chains,
    n_draws: int,
    *,
    walk: str | Walk = 'hit_and_run',
    thin: int = 1,
) -> tuple[Floats, Chains]:
    """
    Run chains for ``n_draws * thin`` further steps, by any walk.

    Parameters
    ----------
    space : Space
        The set that the chains were begun in.
    chains : Chains
        States to start from; they are not changed.
    n_draws : int
        Number of points kept of each chain.
    walk : str or Walk
        A name in ``WALKS``, or a walk with its settings. It may differ from earlier runs.
    thin : int
        Number of steps for each point kept: the point after the last of these steps.

    Returns
    -------
    draws : (n_chains, n_draws, dim) float64
        Points in the caller's frame.
    chains : Chains
        States after the last draw.

    Raises
    ------
    RequestError
        When an argument is malformed, the arrays of the chains do not have the shapes that belong
        to this space, or a log-density is not a finite number at the point of a chain.
    OracleError
        When a log-density in Python raised an exception.
    StuckError
        When a chain has not moved for ``STUCK_AFTER`` (1000) consecutive steps.

    """
    n_draws, thin = check_count('n_draws', n_draws, 0), check_count('thin', thin, 1)
    walk = make_walk(walk)
    compiled = walk.compiled(space)
    _check_fit(space, chains)
    check_start = getattr(walk, 'check_start', None)
    if check_start is not None:
        for point in space.from_kernel(chains.points):
            check_start(point)
    after = Chains(*(array.copy() for array in vars(chains).values()))
    draws = np.empty((len(after.points), n_draws, space.kernel_dim))

    def run(k: int) -> None:
        run_chain(space, compiled, after.chain(k), thin, draws[k])

    if len(draws) == 1:
        run(0)  # in this thread, which may be one that interrupts kernels
    else:
        with ThreadPoolExecutor() as pool:
            list(pool.map(in_this_mode(run), range(len(draws))))
    return space.from_kernel(draws), after


def _check_starts(space: Space, start: ArrayLike) -> Floats:
    """Return the starts as (dim,) or (n_chains, dim) free points, or raise RequestError."""
    starts = check_points('start', start, space.dim)
    for point in np.atleast_2d(starts):
        if not np.isfinite(point).all():
            raise RequestError(f'start must be finite, got {point.tolist()}')
        if not space.contains(point):
            raise RequestError(f'start {point.tolist()} is {space.why_not_free(point)}')
    if starts.size == 0:
        raise RequestError('start must be at least one point, got none')
    return starts


def _check_fit(space: Space, chains: Chains) -> None:
    """Raise RequestError for chains whose arrays have the shapes of another space."""
    wanted = {
        'points': space.kernel_dim,
        'memory': memory_size(space.data, space.kernel_dim),
        'streams': 4,
        'counts': N_COUNTS,
    }
    for name, columns in wanted.items():
        shape = np.shape(getattr(chains, name))
        if shape != (len(chains.points), columns):
            raise RequestError(
                f'chains of this space have {columns} columns of {name}, got shape {shape}'
            )
