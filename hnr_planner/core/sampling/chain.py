"""
A chain: one run of a random walk, and the kernel that takes its steps.

``chains`` runs several of them for the caller; what runs chains of its own begins each by
``new_chain`` and goes on by ``run_chain``.
"""

from typing import Any, NamedTuple

from hnr_planner.core.cancellation import in_chunks
from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import StuckError
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import Stream
from hnr_planner.core.sampling.steps import (
    MOVES,
    N_COUNTS,
    STEPS,
    STILL,
    take_step,
    ZERO_CHORDS,
)
from hnr_planner.core.spaces.chain_cache import memory_size, open_cache, REFRESH, refresh
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import NDArray

#: Steps of one call of the kernel: machine code that has just arrived is used from the next on.
STEPS_AT_ONCE = 4096
#: Number of steps without a move after which a chain is stuck. A chain that moves at one step in
#: fifty has so many with probability .98 ** 1000 = 2e-9.
STUCK_AFTER = 1000


class Chain(NamedTuple):
    """
    State of one chain; ``run_chain`` changes the arrays in place.

    Attributes
    ----------
    x : (dim,)
        Position in the space's kernel frame.
    memory : (k,)
        Numbers that the space caches for position ``x``; k depends on the space.
    rng : (4,) uint64
        State of the random stream that the chain draws from.
    counts : (N_COUNTS,) int64
        Counters, indexed by ``STEPS``, ``MOVES``, ``ZERO_CHORDS``, ``REDRAWS`` and ``STILL`` of
        module ``steps``.

    """

    x: Floats
    memory: Floats
    rng: Stream
    counts: NDArray[np.int64]


def new_chain(space: Space, x: Floats, rng: Stream) -> Chain:
    """
    Return a chain at ``x`` (dim,), a free point in the kernel frame, with all counters 0.

    The chain holds ``x`` and ``rng`` themselves, not copies: ``run_chain`` changes both arrays.
    """
    memory = np.zeros(memory_size(space.data, space.kernel_dim))
    return Chain(x, memory, rng, np.zeros(N_COUNTS, dtype=np.int64))


def run_chain(space: Space, walk: Any, chain: Chain, thin: int, draws: Floats) -> None:
    """
    Run a chain for ``n_draws * thin`` steps, and write every ``thin``-th point into ``draws``.

    ``walk`` is the compiled form of a walk, ``draws`` is (n_draws, kernel_dim), in
    the kernel frame.

    Raises
    ------
    StuckError
        When the chain has not moved for ``STUCK_AFTER`` consecutive steps, counted over all its
        runs.

    """
    u = np.zeros(space.kernel_dim)
    for rows in in_chunks(len(draws), None, max(1, STEPS_AT_ONCE // thin)):
        take_steps(space.data, walk, chain, u, thin, draws[rows])
        if chain.counts[STILL] >= STUCK_AFTER:
            break
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
    """
    Take ``n_draws * thin`` steps, and write every ``thin``-th point into ``draws``.

    Return early once the chain has not moved for ``STUCK_AFTER`` steps: later rows of ``draws``
    (n_draws, dim) are then left unwritten. ``u`` (dim,) is a work array that has to be zero.
    """
    space, chain = borrowed(space), borrowed(chain)
    u, draws = borrowed(u), borrowed(draws)
    x, counts = chain.x, chain.counts
    cache = open_cache(space, x, chain.memory)
    for k in range(len(draws)):
        for _ in range(thin):
            if counts[STEPS] % REFRESH == 0:
                refresh(space, cache)
            counts[STEPS] += 1
            if take_step(walk, space, cache, u, chain.rng, counts):
                counts[MOVES] += 1
                counts[STILL] = 0
            else:
                counts[STILL] += 1
                if counts[STILL] >= STUCK_AFTER:
                    return
        for i in range(len(x)):
            draws[k, i] = x[i]
