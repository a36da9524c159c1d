"""
Distance to obstacles along the paths of different planners (paper, Section 1).

The paper claims that Hit-and-Run's paths are safer, since they are more likely to stay away from
the boundary, while those of RRT tend to be close to the boundary. The paths of both planners, and
of the grid searches that most robots plan with, are measured on maps of floors: as found, and
after the shortening that a path gets before a robot follows it.
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
from hnr_planner.experiments.registry import EXPERIMENTS
from hnr_planner.experiments.requests import far_pairs
from hnr_planner.experiments.results import markdown, Mean, Results
from hnr_planner.maps import building, load_map, OccupancyMap
from matplotlib.axes import Axes
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

#: Generated floors, and their seeds.
FLOORS = {f'floor {seed}': seed for seed in (2, 5, 11)}
#: Environment variable that names a folder of further maps (map_server YAML files).
MAPS_VARIABLE = 'HNR_MAPS'
#: Radius of the robot [m].
ROBOT_RADIUS = 0.22
#: A robot whose edge is nearer than this to an obstacle is near it [m].
NEAR = 0.1
#: Spacing of the points at which the clearance of a path is measured [m], and their largest
#: number: on a longer path, such as a walk of millions of steps, the spacing is wider.
SPACING, POINTS_MAX = 0.02, 500_000
GRID_SEARCHES = {'a_star': a_star, 'wavefront': wavefront}
#: Planners, and the clearance requested of them [m].
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
    """A case: map (a generated floor or the stem of a file), planner, requested clearance [m]."""

    place: str
    algorithm: str
    clearance: float


def cases() -> list[Case]:
    """Return every planner on every generated floor and on the maps of ``MAPS_VARIABLE``."""
    return [Case(place, *planner) for place in [*FLOORS, *_robot_maps()] for planner in PLANNERS]


def _robot_maps() -> dict[str, Path]:
    """Return the map files in the folder that ``MAPS_VARIABLE`` names, by their stems."""
    folder = os.environ.get(MAPS_VARIABLE)
    return {file.stem: file for file in sorted(Path(folder).glob('*.yaml'))} if folder else {}


def run(case: Case, seed: int) -> dict[str, float]:
    """Plan between two distant points; return the measures of the path, found and shortened."""
    space = space_of(case.place)
    (ends,) = far_pairs(space, 1, seed)
    path = _path(space, ends, case, seed)
    # A path with a clearance was shortened before it was moved away from the walls.
    shortened = path if case.clearance else simplify(space, path, seed=seed)
    return {
        f'{shape}_{name}': value
        for shape, of in zip(SHAPES, (path, shortened), strict=True)
        for name, value in measures(space, of).items()
    }


@cache
def space_of(place: str) -> GridSpace:
    """Return the space of the robot's centre on a map, given by its name in the cases."""
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
    Return length [m] and measures of the clearance of the robot's edge along a path (m, 2).

    ``mean`` and ``least`` are clearances [m], ``near`` the fraction of the length near an
    obstacle, ``near_length`` that length [m]. All are means over the length, not over time, so
    that a path does not become safer by waiting in the open.
    """
    clearance = space.clearance(_resampled(path)) - ROBOT_RADIUS
    near = clearance < NEAR
    length = float(np.hypot(*np.diff(path, axis=0).T).sum())
    return {
        'length': length,
        'mean': float(clearance.mean()),
        'least': float(clearance.min()),
        'near': float(near.mean()),
        'near_length': float(near.mean()) * length,
    }


def _resampled(path: NDArray) -> NDArray:
    """Return points (k, 2) at equal distances of about ``SPACING`` [m] along a path (m, 2)."""
    ends = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(path, axis=0).T))])
    n_points = min(max(2, int(ends[-1] / SPACING)), POINTS_MAX)
    at = np.linspace(0.0, ends[-1], n_points)
    return np.stack([np.interp(at, ends, path[:, axis]) for axis in (0, 1)], axis=1)


def _kinds(results: Results) -> dict[str, Results]:
    """Split the results into those on generated floors and, if any, those on robot maps."""
    generated = np.isin(results['place'], list(FLOORS))
    kinds = {'generated floors': results.rows(generated)}
    if not generated.all():
        kinds['robot maps'] = results.rows(~generated)
    return kinds


def figure(results: Results) -> Figure:
    """Draw mean clearance and fraction near obstacles, of paths as found and shortened."""
    kinds = _kinds(results)
    drawn = new_figure(10.0, 0.4 + 3.4 * len(kinds))
    rows = drawn.subplots(len(kinds), 2, squeeze=False)
    for (mean, near), (kind, chosen) in zip(rows, kinds.items(), strict=True):
        _draw_measure(mean, chosen, 'mean')
        _draw_measure(near, chosen, 'near')
        label = 'from the nearest obstacle, past the robot\u2019s radius [m]'
        style(mean, f'{kind.capitalize()}: mean distance', label, '')
        style(near, f'{kind.capitalize()}: near', f'part of the length within {NEAR} m', '')
        near.set_yticklabels([])
        for axes in (mean, near):
            axes.grid(False, axis='y')
    legend(rows[0, 1], 'lower right')
    return drawn


def _draw_measure(axes: Axes, results: Results, measure: str) -> None:
    draw_bars(
        axes,
        [_label(*planner) for planner in PLANNERS],
        {
            shape: [_mean(results, planner, f'{shape}_{measure}') for planner in PLANNERS]
            for shape in SHAPES
        },
        [LOOKS[algorithm].colour for algorithm, _ in PLANNERS],
    )


def tables(results: Results) -> str:
    """Return tables of every planner's measures, over all maps of a kind and on each map."""
    text = (
        'As found: mean distance to the nearest obstacle past the robot\u2019s radius, part of '
        f'the length within {NEAR} m of one, length; then the same, shortened.\n'
    )
    kinds = {f'all {kind}': chosen for kind, chosen in _kinds(results).items()}
    places = {place: results.where(place=place) for place in results.distinct('place')}
    return '\n'.join([text, *(_table(*group) for group in (kinds | places).items())])


def _table(name: str, results: Results) -> str:
    header = [name, 'mean [m]', 'near', 'length [m]']
    header += ['shortened: mean [m]', 'near', 'length [m]']
    columns = [f'{shape}_{name}' for shape in SHAPES for name in ('mean', 'near', 'length')]
    rows = [
        [_label(*planner), *(_mean(results, planner, column) for column in columns)]
        for planner in PLANNERS
    ]
    return markdown(header, rows)


def _mean(results: Results, planner: tuple[str, float], column: str) -> Mean:
    """Return the mean over the maps; the interval is of random runs on these maps only."""
    each = [results.of(Case(place, *planner)).mean(column) for place in results.distinct('place')]
    values, halves = np.array(each).T
    return Mean(float(values.mean()), math.hypot(*halves) / len(each))


def _label(algorithm: str, clearance: float) -> str:
    label = LOOKS[algorithm].label
    return f'{label}, clearance={clearance}' if clearance else label


EXPERIMENT = Experiment(
    EXPERIMENTS['safety'],
    runs=500,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
