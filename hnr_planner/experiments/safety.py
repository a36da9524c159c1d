"""
How far from obstacles the paths of different planners stay (paper, Section 1).

The paper says that Hit-and-Run's paths are safer, since they are more likely to stay away from
the boundary, while those of RRT tend to be close to it. Here both are measured on maps of floors,
beside the grid searches that most robots plan with, and again after shortening, which every path
goes through before a robot follows it.
"""

from functools import cache
import math
import os
from pathlib import Path
from typing import NamedTuple

from hnr_planner.core import GridSpace, plan, simplify
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_bars, legend, LOOKS, new_figure, style
from hnr_planner.experiments.grid_search import a_star, wavefront
from hnr_planner.experiments.requests import far_pairs
from hnr_planner.experiments.results import markdown, Mean, Results
from hnr_planner.maps import building, load_map, OccupancyMap
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

#: Generated floors, and their seeds.
FLOORS = {f'floor {seed}': seed for seed in (2, 5, 11)}
#: Names a folder of robot maps, files of map_server, that take part too.
MAPS_VARIABLE = 'HNR_MAPS'
ROBOT_RADIUS = 0.22
#: Nearer than this to an obstacle [m], past the robot's own radius, is near.
NEAR = 0.1
#: Distance of the points at which the clearance of a path is measured [m]; they are farther apart
#: where a path, the walk of millions of steps, would have more of them than this.
SPACING, POINTS_MAX = 0.02, 500_000
GRID_SEARCHES = {'a_star': a_star, 'wavefront': wavefront}
#: Planners, and the clearance that they are asked to keep [m].
PLANNERS = (
    ('hit_and_run', 0.0),
    ('rrt', 0.0),
    ('auto', 0.0),
    ('a_star', 0.0),
    ('wavefront', 0.0),
    ('auto', 0.5),
)
SHAPES = ('found', 'shortened')


class Case(NamedTuple):
    """A map (a floor, or the stem of a file) and a planner; the clearance is asked for [m]."""

    place: str
    algorithm: str
    clearance: float


def cases() -> list[Case]:
    """List every planner on every map."""
    return [Case(place, *planner) for place in [*FLOORS, *_robot_maps()] for planner in PLANNERS]


def _robot_maps() -> dict[str, Path]:
    """Return the files of the maps in the folder that the environment names, by their stems."""
    folder = os.environ.get(MAPS_VARIABLE)
    return {file.stem: file for file in sorted(Path(folder).glob('*.yaml'))} if folder else {}


def run(case: Case, seed: int) -> dict[str, float]:
    """Plan between two far points of the map, and measure the path as found and shortened."""
    space = space_of(case.place)
    (ends,) = far_pairs(space, 1, seed)
    path = _path(space, ends, case, seed)
    # What keeps a clearance was shortened before it was pushed off the walls.
    shortened = path if case.clearance else simplify(space, path, seed=seed)
    return {
        f'{shape}_{name}': value
        for shape, of in zip(SHAPES, (path, shortened), strict=True)
        for name, value in measures(space, of).items()
    }


@cache
def space_of(place: str) -> GridSpace:
    """Return the space of the robot on a map."""
    occupancy = _occupancy(place)
    return GridSpace.from_occupancy(
        occupancy.data, occupancy.resolution, occupancy.origin, robot_radius=ROBOT_RADIUS
    )


def _occupancy(place: str) -> OccupancyMap:
    return building(FLOORS[place]) if place in FLOORS else load_map(_robot_maps()[place])


def _path(space: GridSpace, ends: NDArray, case: Case, seed: int) -> NDArray:
    if case.algorithm in GRID_SEARCHES:
        search = GRID_SEARCHES[case.algorithm]
        path: NDArray = space.from_kernel(search(space.data, *space.to_kernel(ends)))
        return path
    settings = {'clearance': case.clearance} if case.clearance else {'simplify': False}
    return plan(
        space, *ends, algorithm=case.algorithm, seed=seed, time_limit=np.inf, **settings
    ).path


def measures(space: GridSpace, path: NDArray) -> dict[str, float]:
    """
    Return length, and the clearance along a path, past the robot's radius [m].

    ``near`` is the part of the length that is near an obstacle; with nothing but the length of a
    robot's way in it, a path cannot become safer by dwelling in the open.
    """
    clearance = space.clearance(_spread(path)) - ROBOT_RADIUS
    near = clearance < NEAR
    length = float(np.hypot(*np.diff(path, axis=0).T).sum())
    return {
        'length': length,
        'mean': float(clearance.mean()),
        'least': float(clearance.min()),
        'near': float(near.mean()),
        'near_length': float(near.mean()) * length,
    }


def _spread(path: NDArray) -> NDArray:
    """Return points at equal distances along a path."""
    ends = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    n_points = min(max(2, int(ends[-1] / SPACING)), POINTS_MAX)
    at = np.linspace(0.0, ends[-1], n_points)
    return np.stack([np.interp(at, ends, path[:, axis]) for axis in (0, 1)], axis=1)


def _kinds(results: Results) -> dict[str, Results]:
    """Return the results on generated floors, and those on robot maps if there are any."""
    generated = np.isin(results['place'], list(FLOORS))
    kinds = {'generated floors': results.rows(generated)}
    if not generated.all():
        kinds['robot maps'] = results.rows(~generated)
    return kinds


def figure(results: Results) -> Figure:
    """Draw the mean clearance and the near part of the paths, as found and shortened."""
    kinds = _kinds(results)
    drawn = new_figure(10.0, 0.4 + 3.4 * len(kinds))
    rows = drawn.subplots(len(kinds), 2, squeeze=False)
    for (mean, near), (kind, chosen) in zip(rows, kinds.items(), strict=True):
        _draw_measure(mean, chosen, 'mean')
        _draw_measure(near, chosen, 'near')
        words = 'from the nearest obstacle, past the robot\u2019s radius [m]'
        style(mean, f'{kind.capitalize()}: mean distance', words, '')
        style(near, f'{kind.capitalize()}: near', f'part of the length within {NEAR} m', '')
        near.set_yticklabels([])
        for axes in (mean, near):
            axes.grid(False, axis='y')
    legend(rows[0, 1], 'lower right')
    return drawn


def _draw_measure(axes: Axes, results: Results, measure: str) -> None:
    draw_bars(
        axes,
        [_words(*planner) for planner in PLANNERS],
        {
            shape: [_mean(results, planner, f'{shape}_{measure}') for planner in PLANNERS]
            for shape in SHAPES
        },
        [LOOKS[algorithm].colour for algorithm, _ in PLANNERS],
    )


def tables(results: Results) -> str:
    """Return the measures of every planner, over all maps of a kind and on each map."""
    words = (
        'As found: mean distance to the nearest obstacle past the robot\u2019s radius, part of '
        f'the length within {NEAR} m of one, length; then the same, shortened.\n'
    )
    kinds = {f'all {kind}': chosen for kind, chosen in _kinds(results).items()}
    places = {place: results.where(place=place) for place in results.distinct('place')}
    return '\n'.join([words, *(_table(*group) for group in (kinds | places).items())])


def _table(name: str, results: Results) -> str:
    header = [name, 'mean [m]', 'near', 'length [m]']
    header += ['shortened: mean [m]', 'near', 'length [m]']
    columns = [f'{shape}_{name}' for shape in SHAPES for name in ('mean', 'near', 'length')]
    rows = [
        [_words(*planner), *(_mean(results, planner, column) for column in columns)]
        for planner in PLANNERS
    ]
    return markdown(header, rows)


def _mean(results: Results, planner: tuple[str, float], column: str) -> Mean:
    """Return the mean over the maps; that maps differ makes it no less certain."""
    each = [results.of(Case(place, *planner)).mean(column) for place in results.distinct('place')]
    values, halves = np.array(each).T
    return Mean(float(values.mean()), math.hypot(*halves) / len(each))


def _words(algorithm: str, clearance: float) -> str:
    label = LOOKS[algorithm].label
    return f'{label}, clearance={clearance}' if clearance else label


EXPERIMENT = Experiment(
    name='safety',
    about='Distance to obstacles along the paths of different planners.',
    runs=500,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
