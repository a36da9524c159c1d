"""
Uniform points of all free space, whatever the number of its connected parts.

A walk never leaves its part. So there is one in each part, in the uniform law from the beginning,
and at every draw one of them moves on: that of a part picked with the probability of its area.
Every draw, the first one too, is uniform on all free space, and no step is thrown away.
"""

from concurrent.futures import ThreadPoolExecutor
import math
from typing import NamedTuple

from hnr_planner.core.cancellation import Event, in_chunks
from hnr_planner.core.checks import check_count, check_seed, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.streams import Stream, stream, uniform
from hnr_planner.core.sampling.chains import new_chain, run_chain
from hnr_planner.core.sampling.walks import make_walk, Walk
from hnr_planner.core.spaces.grid.grid_space import GridSpace
import numpy as np
from numpy.typing import NDArray

#: Steps between two looks at a cancellation: some hundredths of a second.
STEPS_AT_ONCE = 2**16


class FreeSpaceDraws(NamedTuple):
    """
    Draws, with the number of the connected part that each lies in.

    Attributes
    ----------
    points : (n_chains, n_draws, dim)
        In the caller's frame.
    parts : (n_chains, n_draws) int
        From 1.
    seed : int
        The one used: with it the same call gives the same draws.

    """

    points: Floats
    parts: NDArray[np.int32]
    seed: int

    @property
    def previous(self) -> NDArray[np.intp]:
        """Index (n_chains, n_draws) of the draw before in the same part; -1 for its first one."""
        previous = np.full(self.parts.shape, -1)
        for chain, parts in enumerate(self.parts):
            for draws in _of_each_part(parts):
                previous[chain, draws[1:]] = draws[:-1]
        return previous


def sample_free_space(
    space: GridSpace,
    n_draws: int,
    *,
    walk: str | Walk = 'hit_and_run',
    n_chains: int = 1,
    thin: int = 1,
    seed: int | None = None,
    cancel: Event | None = None,
) -> FreeSpaceDraws:
    """
    Draw points that are uniform on all free space of a grid.

    Draws of one part are a chain: its first is an independent uniform point, each of the others
    is ``thin`` steps away from the one before. Fewer draws are the first of more.

    Parameters
    ----------
    space : GridSpace
        The set to draw from.
    n_draws : int
        Points of each chain.
    walk : str or Walk
        How to step, as for ``sample``.
    n_chains : int
        Independent repetitions; each runs in a thread and with random streams of its own.
    thin : int
        Steps from a draw to the next one in its part.
    seed : int, optional
        Fresh when left out.
    cancel : Event, optional
        Ends the work when it is set.

    Raises
    ------
    RequestError
        When an argument is malformed.
    SpaceError
        When no cell is free.
    Cancelled
        When ``cancel`` was set.
    StuckError
        When a walk does not move any more.

    """
    n_draws = check_count('n_draws', n_draws, 1)
    n_chains = check_count('n_chains', n_chains, 1)
    thin = check_count('thin', thin, 1)
    step = make_walk(walk).compiled(space)
    seed = check_seed(seed)
    labels = space.data.labels
    free = np.flatnonzero(labels)
    if free.size == 0:
        raise SpaceError('no cell is free')

    points = np.empty((n_chains, n_draws, space.dim))
    parts = np.empty((n_chains, n_draws), dtype=np.int32)

    def fill(chain: int) -> None:
        cells = pick_cells(free, n_draws, np.random.default_rng([seed, chain]))
        parts[chain] = labels.flat[cells]
        for draws in _of_each_part(parts[chain]):
            first, rng = draws[0], stream(seed, chain, int(parts[chain, draws[0]]))
            points[chain, first] = x = point_in_cell(cells[first], labels.shape, rng)
            part = new_chain(space, x, rng)
            moved = np.empty((len(draws) - 1, space.dim))
            for some in in_chunks(len(moved), cancel, max(1, STEPS_AT_ONCE // thin)):
                run_chain(space, step, part, thin, moved[some])
            points[chain, draws[1:]] = moved

    with ThreadPoolExecutor() as pool:
        list(pool.map(fill, range(n_chains)))
    return FreeSpaceDraws(space.from_kernel(points), parts, seed)


def pick_cells(free: NDArray[np.intp], n_draws: int, rng: np.random.Generator) -> NDArray[np.intp]:
    """Pick a free cell for each draw: it says in which part, and where that part starts."""
    return free[(rng.random(n_draws) * len(free)).astype(np.intp)]


def point_in_cell(cell: int, shape: tuple[int, ...], rng: Stream) -> Floats:
    """Draw a uniform point (2,) of a cell, kernel frame, which has one unit for a cell."""
    row, column = divmod(int(cell), shape[1])
    # Halfway between the multiples of 2^-32, where no sum rounds onto the edge of the cell.
    x, y = ((math.floor(uniform(rng) * 2**32) + 0.5) / 2**32 for _ in range(2))
    return np.array([column + x, row + y])


def _of_each_part(parts: NDArray[np.int32]) -> list[NDArray[np.intp]]:
    """Return the indices, ascending, of the draws of each part (n,) that has any."""
    order = np.argsort(parts, kind='stable')
    return np.split(order, 1 + np.flatnonzero(np.diff(parts[order])))
