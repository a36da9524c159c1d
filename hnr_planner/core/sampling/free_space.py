"""
Uniform points of all free space of a grid, over all its connected components.

A walk never leaves its component. So one chain runs in each component, from a start that is
uniform on the component, and every draw advances one of these chains: that of a component chosen
with probability proportional to the component's area. Every draw, the first included, is uniform
on all free space.
"""

from concurrent.futures import ThreadPoolExecutor
import math
from typing import NamedTuple

from hnr_planner.core.cancellation import Event, in_chunks
from hnr_planner.core.checks import check_count, check_seed, Floats, Seed
from hnr_planner.core.errors import RequestError, SpaceError
from hnr_planner.core.kernels.modes import in_this_mode
from hnr_planner.core.kernels.streams import Stream, stream, uniform
from hnr_planner.core.sampling.chain import new_chain, run_chain
from hnr_planner.core.sampling.walks import make_walk, Walk
from hnr_planner.core.spaces.grid.grid_space import GridSpace
import numpy as np
from numpy.typing import NDArray

#: Steps between two checks for cancellation; they take some hundredths of a second.
STEPS_AT_ONCE = 2**16


class FreeSpaceDraws(NamedTuple):
    """
    Draws, with the connected component of each.

    Attributes
    ----------
    points : (n_chains, n_draws, dim)
        Points in the caller's frame.
    components : (n_chains, n_draws) int
        Number of the component that each point lies in, from 1.
    seed : int
        The seed used: with it the same call gives the same draws.

    """

    points: Floats
    components: NDArray[np.int32]
    seed: int

    @property
    def previous(self) -> NDArray[np.intp]:
        """
        Index of each draw's predecessor: the last earlier draw in the same component.

        (n_chains, n_draws), index into the draws of the same chain; -1 for the first draw in a
        component.
        """
        previous = np.full(self.components.shape, -1)
        for chain, components in enumerate(self.components):
            for draws in _draws_by_component(components):
                previous[chain, draws[1:]] = draws[:-1]
        return previous


def sample_free_space(
    space: GridSpace,
    n_draws: int,
    *,
    walk: str | Walk = 'hit_and_run',
    n_chains: int = 1,
    thin: int = 1,
    seed: Seed = None,
    cancel: Event | None = None,
) -> FreeSpaceDraws:
    """
    Draw points that are uniform on all free space of a grid.

    The draws in one component form a chain: the first is an independent uniform point, and each
    later one is ``thin`` steps from the one before. A run with fewer draws is the beginning of a
    run with more.

    Parameters
    ----------
    space : GridSpace
        The set to draw from.
    n_draws : int
        Points of each chain.
    walk : str or Walk
        A name in ``WALKS``, or a walk with its settings.
    n_chains : int
        Independent repetitions; each runs in its own thread with its own random streams.
    thin : int
        Steps between consecutive draws in one component.
    seed : int, numpy.random.SeedSequence, numpy.random.Generator or None
        Fresh when left out. A generator is advanced, so that the next call gives other draws.
    cancel : Event, optional
        Ends the work when the event is set, from any thread.

    Raises
    ------
    RequestError
        When an argument is malformed, or the space is not a grid.
    SpaceError
        When no cell is free.
    Cancelled
        When ``cancel`` was set before all draws were made.
    StuckError
        When the chain of a component has not moved for 1000 consecutive steps.

    """
    if not isinstance(space, GridSpace):
        raise RequestError(
            f'sample_free_space needs a GridSpace, whose components are known, got a '
            f"{type(space).__name__}: sample(space, start, ...) draws from the start's component"
        )
    n_draws = check_count('n_draws', n_draws, 1)
    n_chains = check_count('n_chains', n_chains, 1)
    thin = check_count('thin', thin, 1)
    compiled = make_walk(walk).compiled(space)
    seed = check_seed(seed)
    labels = space.data.labels
    free = np.flatnonzero(labels)
    if free.size == 0:
        raise SpaceError('no cell is free')

    points = np.empty((n_chains, n_draws, space.dim))
    components = np.empty((n_chains, n_draws), dtype=np.int32)

    def fill(chain: int) -> None:
        cells = pick_cells(free, n_draws, np.random.default_rng([seed, chain]))
        components[chain] = labels.flat[cells]
        for draws in _draws_by_component(components[chain]):
            first, rng = draws[0], stream(seed, chain, int(components[chain, draws[0]]))
            points[chain, first] = x = point_in_cell(cells[first], labels.shape, rng)
            state = new_chain(space, x, rng)
            later = np.empty((len(draws) - 1, space.dim))
            for rows in in_chunks(len(later), cancel, max(1, STEPS_AT_ONCE // thin)):
                run_chain(space, compiled, state, thin, later[rows])
            points[chain, draws[1:]] = later

    if n_chains == 1:  # in the caller's thread, which may be one that interrupts kernels
        fill(0)
    else:
        with ThreadPoolExecutor() as pool:
            list(pool.map(in_this_mode(fill), range(n_chains)))
    return FreeSpaceDraws(space.from_kernel(points), components, seed)


def pick_cells(free: NDArray[np.intp], n_draws: int, rng: np.random.Generator) -> NDArray[np.intp]:
    """
    Return a cell for each draw, drawn uniformly from the cells ``free`` (k,): (n_draws,).

    Cells are indices into the flattened grid of labels. The cell determines the component of the
    draw; the first cell in a component is also where the chain of the component starts.
    """
    return free[(rng.random(n_draws) * len(free)).astype(np.intp)]


def point_in_cell(cell: int, shape: tuple[int, ...], rng: Stream) -> Floats:
    """
    Draw a uniform point (2,) of a cell, in the kernel frame (units of cells).

    ``cell`` is an index into the flattened grid of labels, ``shape`` the shape of that grid.
    """
    row, column = divmod(int(cell), shape[1])
    # Halfway between the multiples of 2^-32, where no sum rounds onto the edge of the cell.
    x, y = ((math.floor(uniform(rng) * 2**32) + 0.5) / 2**32 for _ in range(2))
    return np.array([column + x, row + y])


def _draws_by_component(components: NDArray[np.int32]) -> list[NDArray[np.intp]]:
    """
    Return, for each component that has draws, the indices of these draws in ascending order.

    ``components`` (n,) is the component of every draw of one chain.
    """
    order = np.argsort(components, kind='stable')
    return np.split(order, 1 + np.flatnonzero(np.diff(components[order])))
