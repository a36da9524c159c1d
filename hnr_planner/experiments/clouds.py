"""
Measures of the samples of Hit-and-Run and RRT in the spiral (paper, section "Planning").

The paper claims that RRT covers the spiral more evenly and that Hit-and-Run moves fast along
straight corridors; that RRT slows down towards the end, since the rest of its tree absorbs most
samples; and that RRT wastes samples along the boundaries.
"""

from functools import cache
from typing import NamedTuple

from hnr_planner.core import GridSpace, PlanResult
from hnr_planner.drawing import FAINT_INK
from hnr_planner.experiments import spiral
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_profile, legend, LOOKS, new_figure, style
from hnr_planner.experiments.grid_search import potential
from hnr_planner.experiments.registry import EXPERIMENTS
from hnr_planner.experiments.results import markdown, Results
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

#: Widths of the arms [m], the one that is drawn, and the planners.
WIDTHS = (0.8, 1.2, 1.6, 2.0)
SHOWN_WIDTH = 1.2
PLANNERS = ('hit_and_run', 'rrt')
#: Independent uniform points as a reference: the value of each measure by chance alone.
UNIFORM = 'uniform'
#: Equal sections of the way from start to goal, and slices of equal area across the corridor.
N_PARTS, N_SLICES = 20, 40
#: Points of a run that its evenness is measured on: its value by chance depends on their number.
N_EVEN = 400
#: Layers of equal width from the wall to the middle of the corridor; the first is at the wall.
N_LAYERS = 10
#: Points nearer to a wall than this count as points on it [m].
ON_WALL = 1e-6
#: Columns of the results: samples until each section of the way, density by slice and layer.
ARRIVALS = [f'arrival_{k + 1}' for k in range(N_PARTS)]
SLICES = [f'slice_{k}' for k in range(N_SLICES)]
LAYERS = [f'layer_{k}' for k in range(N_LAYERS)]
#: Columns that independent points do not have.
SEARCH_COLUMNS = ['transitions', 'rejected', 'step', *ARRIVALS]
#: Headers of the table, and the column of each.
TABLE_COLUMNS = {
    'transitions': 'transitions',
    'samples to half the way': ARRIVALS[N_PARTS // 2 - 1],
    'to the goal': ARRIVALS[-1],
    'for the last tenth': 'last_tenth',
    'mean step [m]': 'step',
    'unevenness': 'uneven',
    'density at the wall': LAYERS[0],
    'on a wall [%]': 'percent_on_wall',
    'rejected for each transition': 'rejected',
}


class Case(NamedTuple):
    """A case: width of the corridor [m], and a planner or ``UNIFORM`` for independent points."""

    width: float
    algorithm: str


class Straightened(NamedTuple):
    """
    The spiral with coordinates along and across its corridor.

    Attributes
    ----------
    space : GridSpace
        The spiral.
    width : float
        Width of the corridor [m].
    way : (rows * columns,)
        Distance of each cell from the start along the corridor, as a fraction of the distance of
        the goal; row-major.
    edges : (N_SLICES + 1,)
        Edges of the slices of equal area, as values of ``way``.
    layers : (N_LAYERS,)
        Fraction of the free area in each layer, from the wall to the middle.

    """

    space: GridSpace
    width: float
    way: NDArray[np.float64]
    edges: NDArray[np.float64]
    layers: NDArray[np.float64]


def cases() -> list[Case]:
    """Return every width with every planner and with the uniform points."""
    return [Case(width, name) for width in WIDTHS for name in (*PLANNERS, UNIFORM)]


def run(case: Case, seed: int) -> dict[str, float]:
    """Search once, or draw uniform points, and return the measures of the samples."""
    corridor = straightened(case.width)
    rng = np.random.default_rng(seed)
    if case.algorithm == UNIFORM:
        points = _uniform_points(corridor.space, rng)
        searched = dict.fromkeys(SEARCH_COLUMNS, np.nan)
    else:
        search = spiral.Case(case.width, case.width, case.algorithm, 'region')
        result = spiral.search(search, seed)
        points, searched = result.samples, _searched(corridor, result)
    return {**searched, **_evenness(corridor, points, rng), **_nearness(corridor, points)}


@cache
def straightened(width: float) -> Straightened:
    """Build the spiral of a width [m] and compute its coordinates."""
    made, space = spiral.built(width, width)
    from_start = potential(space.data, space.to_kernel(np.array(made.start)))
    way = from_start / from_start[_cells(space, np.array([made.goal]))[0]]
    free = np.sort(way[np.isfinite(way)])
    rows, columns = np.nonzero(~made.blocked)
    return Straightened(
        space,
        width,
        way,
        edges=np.quantile(free, np.linspace(0.0, 1.0, N_SLICES + 1)),
        layers=_in_layers(space, width, space.cell_centres(rows, columns)),
    )


def _cells(space: GridSpace, points: NDArray) -> NDArray[np.int64]:
    """Return the index (k,) of the cell of each point (k, 2), row-major as in ``potential``."""
    columns, rows = np.floor(space.to_kernel(points)).astype(int).T
    return rows * space.data.free_distance.shape[1] + columns


def _uniform_points(space: GridSpace, rng: np.random.Generator) -> NDArray[np.float64]:
    """Draw ``4 * N_EVEN`` independent uniform points (k, 2) of the free space."""
    rows, columns = np.nonzero(~space.blocked)
    k = rng.integers(len(rows), size=4 * N_EVEN)
    shift = rng.uniform(-0.5, 0.5, (2, len(k)))
    return space.cell_centres(rows[k] + shift[0], columns[k] + shift[1])


def _searched(corridor: Straightened, result: PlanResult) -> dict[str, float]:
    """Return the measures of the search itself: transitions, mean step, and arrivals."""
    way = _way(corridor, result.samples)
    children = np.flatnonzero(result.parents >= 0)
    steps = result.samples[children] - result.samples[result.parents[children]]
    return {
        'transitions': result.iterations,
        'rejected': result.counts.get('rejected_proposals', 0) / result.iterations,
        'step': float(np.hypot(*steps.T).mean()),
        **dict(zip(ARRIVALS, _arrivals(way).tolist(), strict=True)),
    }


def _arrivals(way: NDArray) -> NDArray[np.float64]:
    """
    Return the number of samples (N_PARTS,) before the end of each section of the way is reached.

    ``way`` (k,) has the fraction of the way at each sample, in the order of the search.
    """
    farthest = np.maximum.accumulate(way)
    fractions = np.linspace(0.0, 1.0, N_PARTS + 1)[1:]
    # The search ends in the goal's region, which begins before the goal.
    return np.minimum(np.searchsorted(farthest, fractions), len(way) - 1).astype(float)


def _way(corridor: Straightened, points: NDArray) -> NDArray[np.float64]:
    """Return the fraction of the way (k,) at points (k, 2); on walls, in a free cell beside."""
    way = corridor.way[_cells(corridor.space, points)]
    if not np.isfinite(way).all():
        for offset in (-1e-6, 1e-6):
            beside = corridor.way[_cells(corridor.space, points + offset)]
            way = np.where(np.isfinite(way), way, beside)
    return way


def _evenness(
    corridor: Straightened, points: NDArray, rng: np.random.Generator
) -> dict[str, float]:
    """
    Return the density of the samples in each slice (1 for uniform points), and ``uneven``.

    ``uneven`` is the total variation distance between the fractions of ``N_EVEN`` random samples
    in the slices and equal fractions: 0 is perfectly even. It is nan for a run of fewer samples.
    """
    way = _way(corridor, points)
    uneven = np.nan
    if len(way) >= N_EVEN:
        chosen = rng.choice(way, N_EVEN, replace=False)
        uneven = 0.5 * float(np.abs(_shares(chosen, corridor.edges) - 1.0 / N_SLICES).sum())
    densities = (_shares(way, corridor.edges) * N_SLICES).tolist()
    return {'uneven': uneven, **dict(zip(SLICES, densities, strict=True))}


def _shares(way: NDArray, edges: NDArray) -> NDArray[np.float64]:
    """Return the fraction (N_SLICES,) of points, given by their ``way`` (k,), in each slice."""
    counts = np.histogram(np.clip(way, edges[0], edges[-1]), edges)[0]
    return counts / len(way)


def _nearness(corridor: Straightened, points: NDArray) -> dict[str, float]:
    """
    Return the fraction of points (k, 2) on a wall, and their density in each layer.

    The density of uniform points is 1.
    """
    densities = _in_layers(corridor.space, corridor.width, points) / corridor.layers
    return {
        'on_wall': float((corridor.space.clearance(points) < ON_WALL).mean()),
        **dict(zip(LAYERS, densities.tolist(), strict=True)),
    }


def _in_layers(space: GridSpace, width: float, points: NDArray) -> NDArray[np.float64]:
    """
    Return the fraction (N_LAYERS,) of points (k, 2) in each layer.

    Points farther from walls than half the width, in corners, count as the middle layer.
    """
    depth = space.clearance(points) / (width / 2.0)
    layers = np.minimum((depth * N_LAYERS).astype(int), N_LAYERS - 1)
    return np.bincount(layers, minlength=N_LAYERS) / len(points)


def figure(results: Results) -> Figure:
    """Draw arrivals along the way, and the density along and across the corridor."""
    drawn = new_figure(10.0, 3.9)
    panels = drawn.subplots(1, 3)
    for name in PLANNERS:
        shown = results.of(Case(SHOWN_WIDTH, name))
        for axes, columns, first in zip(
            panels, (ARRIVALS, SLICES, LAYERS), (1.0, 0.5, 0.5), strict=True
        ):
            percent = (np.arange(len(columns)) + first) * 100.0 / len(columns)
            draw_profile(axes, percent, [shown.mean(column) for column in columns], LOOKS[name])
    arrivals, along, across = panels
    for axes in (along, across):
        axes.axhline(1.0, color=FAINT_INK, linewidth=1.0, linestyle=':')
    along.set_ylim(bottom=0.0)
    style(arrivals, 'How soon they get how far', 'part of the way [%]', 'samples until there')
    style(along, 'Density along the corridor', 'from start to goal [% of area]', 'uniform = 1')
    style(across, 'Density across it', 'from wall to middle [%]', 'uniform = 1')
    legend(arrivals, 'upper left')
    return drawn


def tables(results: Results) -> str:
    """Return a table with the measures of every width and planner."""
    derived = {
        'last_tenth': results[ARRIVALS[-1]] - results[ARRIVALS[-1 - N_PARTS // 10]],
        'percent_on_wall': 100.0 * results['on_wall'],
    }
    results = Results({**results.columns, **derived})
    rows = [
        [_label(case), *(results.of(case).mean(column) for column in TABLE_COLUMNS.values())]
        for case in cases()
    ]
    return markdown(['width [m], points', *TABLE_COLUMNS], rows)


def _label(case: Case) -> str:
    uniform = case.algorithm == UNIFORM
    label = 'independent uniform points' if uniform else LOOKS[case.algorithm].label
    return f'{case.width}, {label}'


EXPERIMENT = Experiment(
    EXPERIMENTS['clouds'],
    runs=500,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
