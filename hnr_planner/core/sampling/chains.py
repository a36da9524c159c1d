"""
Chains: runs of a walk that stop and go on as if they never had.

What a chain is at a step is a few numbers: its point, its random stream, what the space remembers
there, and counts. ``begin_chains`` makes them, ``walk_on`` returns draws and the chains after
them, and nothing else changes: two runs of half the length give what one long run gives, to the
last bit. Chains are arrays only, so that a file can hold them:

>>> np.savez('chains.npz', **vars(chains))
>>> chains = Chains(**np.load('chains.npz'))
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_count, check_points, check_seed, Floats
from hnr_planner.core.errors import RequestError, StuckError
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream, stream
from hnr_planner.core.sampling.walks import (
    make_walk,
    MOVES,
    N_COUNTS,
    REDRAWS,
    STEPS,
    STILL,
    take_step,
    Walk,
    ZERO_CHORDS,
)
from hnr_planner.core.spaces.chain_cache import memory_size, open_cache, REFRESH, refresh
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: A chain that does not move in so many steps is stuck. One step in fifty that moves is enough: a
#: walk of such steps fails once in 6e8 chances.
STUCK_AFTER = 1000


class Chain(NamedTuple):
    """
    One chain, which a run moves along.

    Attributes
    ----------
    x : (dim,)
        Where it is, in the space's kernel frame.
    memory : (k,)
        What the space remembers there.
    rng : (4,) uint64
        Its random stream.
    counts : (5,) int64
        What is counted of it.

    """

    x: Floats
    memory: Floats
    rng: Stream
    counts: NDArray[np.int64]


def new_chain(space: Space, x: Floats, rng: Stream) -> Chain:
    """Return a chain at ``x`` (dim,), a free point in the kernel frame, which it moves."""
    memory = np.zeros(memory_size(space.data, space.dim))
    return Chain(x, memory, rng, np.zeros(N_COUNTS, dtype=np.int64))


def run_chain(space: Space, step: Any, chain: Chain, thin: int, draws: Floats) -> None:
    """
    Walk on, and fill ``draws`` (n_draws, dim), one of every ``thin`` steps, kernel frame.

    Raises
    ------
    StuckError
        When the chain does not move any more.

    """
    take_steps(space.data, step, chain, np.zeros(space.dim), thin, draws)
    if chain.counts[STILL] >= STUCK_AFTER:
        steps, moves, zero_chords = chain.counts[[STEPS, MOVES, ZERO_CHORDS]]
        raise StuckError(
            f'a chain has not moved in {STUCK_AFTER} steps from '
            f'{space.from_kernel(chain.x).tolist()}: of {steps} steps {moves} moved it, '
            f'{zero_chords} had no chord longer than {space.zero_length * space.scale:g}; a ball '
            f'walk needs a smaller radius, others a start that is farther from the boundary'
        )


@kernel
def take_steps(space, walk, chain, u, thin, draws):
    """Take steps until ``draws`` (n_draws, dim) are full or the chain is stuck; ``u`` is room."""
    space, chain = borrowed(space), borrowed(chain)
    u, draws = borrowed(u), borrowed(draws)
    x, counts = chain.x, chain.counts
    here = open_cache(space, x, chain.memory)
    for k in range(len(draws)):
        for _ in range(thin):
            if counts[STEPS] % REFRESH == 0:
                refresh(space, here)
            counts[STEPS] += 1
            counts[STILL] += 1
            take_step(walk, space, here, u, chain.rng, counts)
            if counts[STILL] >= STUCK_AFTER:
                return
        for i in range(len(x)):
            draws[k, i] = x[i]


@dataclass(frozen=True, eq=False)
class Chains:
    """
    Chains between two steps; the same space goes with them always.

    Attributes
    ----------
    points : (n_chains, dim)
        Where they are, in the space's kernel frame.
    memory : (n_chains, k)
        What the space remembers there.
    streams : (n_chains, 4) uint64
        Their random streams.
    counts : (n_chains, 5) int64
        The columns below, and steps since the last move.

    """

    points: Floats
    memory: Floats
    streams: NDArray[np.uint64]
    counts: NDArray[np.int64]

    def chain(self, k: int) -> Chain:
        """Return a view of chain ``k``."""
        return Chain(self.points[k], self.memory[k], self.streams[k], self.counts[k])

    @property
    def steps(self) -> NDArray[np.int64]:
        """Steps (n_chains,) taken so far."""
        return self.counts[:, STEPS]

    @property
    def moves(self) -> NDArray[np.int64]:
        """Steps (n_chains,) that moved the chain: of the ball walk, those not refused."""
        return self.counts[:, MOVES]

    @property
    def zero_chords(self) -> NDArray[np.int64]:
        """Steps (n_chains,) whose chord was shorter than the space's margin."""
        return self.counts[:, ZERO_CHORDS]

    @property
    def redraws(self) -> NDArray[np.int64]:
        """Draws (n_chains,) thrown away because they rounded onto the boundary."""
        return self.counts[:, REDRAWS]


def begin_chains(
    space: Space, start: ArrayLike, *, n_chains: int = 1, seed: int | None = None
) -> Chains:
    """
    Put chains at their start, each with a random stream of its own.

    Parameters
    ----------
    space : Space
        The set to draw from.
    start : (dim,) or (n_chains, dim)
        A free point for all, or one for each; ``n_chains`` may then be left out.
    n_chains : int
        Independent chains.
    seed : int, optional
        Fresh when left out. The first chains are the same however many there are.

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
    Let chains take ``n_draws`` times ``thin`` further steps; they may change their walk.

    Parameters
    ----------
    space : Space
        The set that the chains began in.
    chains : Chains
        They stay as they are.
    n_draws : int
        Points kept of each chain.
    walk : str or Walk
        A name in ``WALKS``, or a walk with its settings.
    thin : int
        One point is kept of every ``thin`` steps, the last.

    Returns
    -------
    draws : (n_chains, n_draws, dim) float64
        Points in the caller's frame.
    chains : Chains
        After the last draw.

    Raises
    ------
    RequestError
        When an argument is malformed, or the chains are not of this space.
    StuckError
        When a chain does not move any more.

    """
    n_draws, thin = check_count('n_draws', n_draws, 0), check_count('thin', thin, 1)
    step = make_walk(walk).compiled(space)
    _check_fit(space, chains)
    after = Chains(*(array.copy() for array in vars(chains).values()))
    draws = np.empty((len(after.points), n_draws, space.dim))

    def run(k: int) -> None:
        run_chain(space, step, after.chain(k), thin, draws[k])

    with ThreadPoolExecutor() as pool:
        list(pool.map(run, range(len(draws))))
    return space.from_kernel(draws), after


def _check_starts(space: Space, start: ArrayLike) -> Floats:
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
    """Refuse chains of another space as far as their shape tells."""
    wanted = {
        'points': space.dim,
        'memory': memory_size(space.data, space.dim),
        'streams': 4,
        'counts': N_COUNTS,
    }
    for name, columns in wanted.items():
        shape = np.shape(getattr(chains, name))
        if shape != (len(chains.points), columns):
            raise RequestError(
                f'chains of this space have {columns} columns of {name}, got shape {shape}'
            )
