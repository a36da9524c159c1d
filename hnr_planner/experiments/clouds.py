"""
What the sample clouds of Hit-and-Run and RRT look like, as numbers (paper, section "Planning").

Of the samples of one run on the spiral the paper says that RRT covers it more evenly and
Hit-and-Run speeds along straight halls; that RRT slows down towards the end, since the rest of its
tree absorbs most samples; and that RRT wastes samples along the boundaries.
"""

from functools import cache
from typing import NamedTuple

from hnr_planner.core import GridSpace
from hnr_planner.drawing import FAINT_INK
from hnr_planner.experiments import spiral
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_profile, legend, LOOKS, new_figure, style
from hnr_planner.experiments.grid_search import potential
from hnr_planner.experiments.results import markdown, Results
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

WIDTHS = (0.8, 1.2, 1.6, 2.0)
SHOWN_WIDTH = 1.2
ALGORITHMS = ('hit_and_run', 'rrt')
#: Independent uniform points, to compare with: what chance alone does to each measure.
UNIFORM = 'uniform'
#: Parts of the way from start to goal, and slices of the corridor of equal area across it.
N_PARTS, N_SLICES = 20, 40
#: Points of a run that its evenness is measured on; chance depends on their number.
N_EVEN = 400
#: Layers of the corridor from wall to middle, of equal width; the first one is near the wall.
N_LAYERS = 10
#: Columns of the tables, and what they are.
TOLD = {
    'transitions': 'transitions',
    f'arrival_{N_PARTS // 2}': 'samples to half the way',
    'last_tenth': 'for the last tenth',
    'step': 'mean step [m]',
    'uneven': 'unevenness',
    'layer_0': 'density at the wall',
    'walls': 'on a wall [%]',
    'rejected': 'rejected for each transition',
}
#: A point this near to a wall lies on it [m].
ON_WALL = 1e-6


class Case(NamedTuple):
    """A width of the corridor [m] and a planner, or independent uniform points."""

    width: float
    algorithm: str


class Corridor(NamedTuple):
    """
    The spiral straightened.

    ``way`` (rows * columns,) is the distance of each cell from the start along the corridor, as a
    part of the goal's; ``edges`` (N_SLICES + 1,) are those of the slices of equal area; ``layers``
    (N_LAYERS,) is the part of the area in each layer.
    """

    space: GridSpace
    way: NDArray[np.float64]
    edges: NDArray[np.float64]
    layers: NDArray[np.float64]


def cases() -> list[Case]:
    """List every width with every planner, and the uniform points."""
    return [Case(width, name) for width in WIDTHS for name in (*ALGORITHMS, UNIFORM)]


def run(case: Case, seed: int) -> dict[str, float]:
    """Search once, and measure the samples."""
    corridor = corridor_of(case.width)
    rng = np.random.default_rng(seed)
    if case.algorithm == UNIFORM:
        points, searched = _uniform_points(corridor, rng), _NOT_SEARCHED
    else:
        search = spiral.Case('even', case.width, case.width, case.algorithm, 'region')
        result = spiral.search(search, seed)
        points = result.samples
        searched = {
            'transitions': result.iterations,
            'rejected': result.counts.get('rejected_proposals', 0) / result.iterations,
            'step': float(_edges(result.samples, result.parents).mean()),
            **_arrivals(_way(corridor, points)),
        }
    return {
        **searched,
        **_evenness(corridor, points, rng),
        **_layers(corridor, points, case.width),
    }


@cache
def corridor_of(width: float) -> Corridor:
    """Measure a spiral."""
    made, space = spiral.built(width, width)
    from_start = potential(space.data, space.to_kernel(np.array(made.start)))
    way = from_start / from_start[_cells(space, np.array([made.goal]))[0]]
    free = np.sort(way[np.isfinite(way)])
    rows, columns = np.nonzero(~made.blocked)
    return Corridor(
        space,
        way,
        edges=np.quantile(free, np.linspace(0.0, 1.0, N_SLICES + 1)),
        layers=_in_layers(space, space.cell_centres(rows, columns), width),
    )


def _cells(space: GridSpace, points: NDArray) -> NDArray[np.int64]:
    """Return the number (k,) of the cell of each point (k, 2), as ``potential`` counts them."""
    columns, rows = np.floor(space.to_kernel(points)).astype(int).T
    return rows * space.data.free_distance.shape[1] + columns


def _way(corridor: Corridor, points: NDArray) -> NDArray[np.float64]:
    """Return how far along the corridor points are; one on a wall counts with a cell beside it."""
    way = corridor.way[_cells(corridor.space, points)]
    if not np.isfinite(way).all():
        for offset in (-1e-6, 1e-6):
            beside = corridor.way[_cells(corridor.space, points + offset)]
            way = np.where(np.isfinite(way), way, beside)
    return way


def _edges(samples: NDArray, parents: NDArray) -> NDArray[np.float64]:
    """Return the lengths of the tree's or chain's edges."""
    children = np.flatnonzero(parents >= 0)
    return np.hypot(*(samples[children] - samples[parents[children]]).T)


def _arrivals(way: NDArray) -> dict[str, float]:
    """Return the number of samples before the first one this part of the way from the start."""
    farthest = np.maximum.accumulate(way)
    parts = np.linspace(0.0, 1.0, N_PARTS + 1)[1:]
    # The search ends in the goal's region, which begins before the goal.
    at = np.minimum(np.searchsorted(farthest, parts), len(way) - 1)
    return {f'arrival_{k + 1}': float(first) for k, first in enumerate(at)}


#: What a search has, and uniform points have not.
_NOT_SEARCHED = dict.fromkeys(
    ['transitions', 'rejected', 'step', *(f'arrival_{k + 1}' for k in range(N_PARTS))], np.nan
)


def _evenness(corridor: Corridor, points: NDArray, rng: np.random.Generator) -> dict[str, float]:
    """
    Return the part of the samples in each slice, times the number of slices, and ``uneven``.

    That is the total variation distance between the slices of ``N_EVEN`` of the samples and equal
    ones: 0 is as even as can be. It is nan for a run of fewer samples.
    """
    way = _way(corridor, points)
    shares = _histogram(way, corridor.edges)
    uneven = np.nan
    if len(points) >= N_EVEN:
        some = rng.choice(way, N_EVEN, replace=False)
        uneven = 0.5 * float(np.abs(_histogram(some, corridor.edges) - 1.0 / N_SLICES).sum())
    return {
        'uneven': uneven,
        **{f'slice_{k}': float(share) * N_SLICES for k, share in enumerate(shares)},
    }


def _histogram(way: NDArray, edges: NDArray) -> NDArray[np.float64]:
    counts = np.histogram(np.clip(way, edges[0], edges[-1]), edges)[0]
    return counts / len(way)


def _layers(corridor: Corridor, points: NDArray, width: float) -> dict[str, float]:
    """Return the density of the samples in each layer, and the part of them on a wall."""
    density = _in_layers(corridor.space, points, width) / corridor.layers
    return {
        'on_wall': float((corridor.space.clearance(points) < ON_WALL).mean()),
        **{f'layer_{k}': float(value) for k, value in enumerate(density)},
    }


def _in_layers(space: GridSpace, points: NDArray, width: float) -> NDArray[np.float64]:
    """Return the part of points in each layer; corners of the corridor count as its middle."""
    depth = space.clearance(points) / (width / 2.0)
    layers = np.minimum((depth * N_LAYERS).astype(int), N_LAYERS - 1)
    return np.bincount(layers, minlength=N_LAYERS) / len(points)


def _uniform_points(corridor: Corridor, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw independent uniform points."""
    rows, columns = np.nonzero(~corridor.space.blocked)
    k = rng.integers(len(rows), size=4 * N_EVEN)
    shift = rng.uniform(-0.5, 0.5, (2, len(k)))
    return corridor.space.cell_centres(rows[k] + shift[0], columns[k] + shift[1])


def figure(results: Results) -> Figure:
    """Draw arrivals along the way, and the density along and across the corridor."""
    drawn = new_figure(10.0, 3.9)
    arrivals, along, across = drawn.subplots(1, 3)
    here = results.where(width=SHOWN_WIDTH)
    part = np.linspace(0.0, 100.0, N_PARTS + 1)[1:]
    slices = (np.arange(N_SLICES) + 0.5) * 100.0 / N_SLICES
    layers = (np.arange(N_LAYERS) + 0.5) * 100.0 / N_LAYERS
    for name in ALGORITHMS:
        of, look = here.where(algorithm=name), LOOKS[name]
        draw_profile(arrivals, part, [of.mean(f'arrival_{k + 1}') for k in range(N_PARTS)], look)
        draw_profile(along, slices, [of.mean(f'slice_{k}') for k in range(N_SLICES)], look)
        draw_profile(across, layers, [of.mean(f'layer_{k}') for k in range(N_LAYERS)], look)
    for axes in (along, across):
        axes.axhline(1.0, color=FAINT_INK, linewidth=1.0, linestyle=':')
    along.set_ylim(bottom=0.0)
    style(arrivals, 'How soon they get how far', 'part of the way [%]', 'samples until there')
    style(along, 'Density along the corridor', 'from start to goal [% of area]', 'uniform = 1')
    style(across, 'Density across it', 'from wall to middle [%]', 'uniform = 1')
    legend(arrivals, 'upper left')
    return drawn


def tables(results: Results) -> str:
    """Return the measures for every width."""
    header = ['width [m], points', *TOLD.values()]
    rows = []
    for width in results.distinct('width'):
        for name in (*ALGORITHMS, UNIFORM):
            of = results.where(width=width, algorithm=name)
            last_tenth = of[f'arrival_{N_PARTS}'] - of[f'arrival_{N_PARTS - N_PARTS // 10}']
            of = Results({**of.columns, 'last_tenth': last_tenth, 'walls': 100 * of['on_wall']})
            label = LOOKS[name].label if name in LOOKS else 'independent uniform points'
            means = [of.mean(column) for column in TOLD]
            rows.append([f'{width}, {label}', *means])
    return markdown(header, rows)


EXPERIMENT = Experiment(
    name='clouds',
    about='The samples of a search through the spiral: how soon, how evenly, how near to walls.',
    runs=500,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
