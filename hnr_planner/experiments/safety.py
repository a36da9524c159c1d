"""
How far from obstacles the paths of different planners stay (paper, Section 1).

The paper says that Hit-and-Run's paths are safer, since they are more likely to stay away from
the boundary, while those of RRT tend to be close to it. Here both are measured on maps of floors,
beside the grid searches that most robots plan with, and again after shortening, which every path
goes through before a robot follows it.
"""

from functools import cache
import os
from pathlib import Path
from typing import NamedTuple

from hnr_planner.core import GridSpace, plan, simplify
from hnr_planner.experiments.experiment import Experiment
from hnr_planner.experiments.figures import draw_bars, legend, LOOKS, new_figure, style
from hnr_planner.experiments.grid_search import a_star, wavefront
from hnr_planner.experiments.results import markdown, Results
from hnr_planner.maps import building, load_map, OccupancyMap
from matplotlib.figure import Figure
import numpy as np
from numpy.typing import NDArray

#: Generated floors; HNR_MAPS may name a folder of further maps, files of map_server.
FLOORS = (2, 5, 11)
ROBOT_RADIUS = 0.22
#: Nearer than this to an obstacle [m], past the robot's own radius, is near.
NEAR = 0.1
#: Distance of the points at which the clearance of a path is measured [m].
SPACING = 0.02
#: Least distance of start and goal, as a part of the diagonal of the free space.
LEAST_APART = 0.4
GRID_SEARCHES = {'a_star': a_star, 'wavefront': wavefront}
ALGORITHMS = ('hit_and_run', 'rrt', 'auto', *GRID_SEARCHES)
#: What is asked for beside them: ``plan(..., clearance=...)`` [m].
CLEARANCE = 0.5
SHAPES = ('found', 'shortened')


class Case(NamedTuple):
    """A map (a floor, or a file) and a planner on it; ``clearance`` is the one asked for [m]."""

    place: str
    algorithm: str
    clearance: float


def cases() -> list[Case]:
    """List every planner on every map."""
    folder = os.environ.get('HNR_MAPS')
    files = sorted(Path(folder).glob('*.yaml')) if folder else []
    names = [f'floor {seed}' for seed in FLOORS] + [str(file) for file in files]
    planners = [(algorithm, 0.0) for algorithm in ALGORITHMS] + [('auto', CLEARANCE)]
    return [Case(name, *planner) for name in names for planner in planners]


def run(case: Case, seed: int) -> dict[str, float]:
    """Plan between two far points of the map, and measure the path as found and shortened."""
    space = space_of(case.place)
    ends = request(space, seed)
    path = _path(space, ends, case, seed)
    # What keeps a clearance was shortened before it was pushed off the walls.
    shortened = path if case.clearance else simplify(space, path, seed=seed)
    return {
        f'{shape}_{name}': value
        for shape, of in zip(SHAPES, (path, shortened), strict=True)
        for name, value in measures(space, of).items()
    }


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
    at = np.linspace(0.0, ends[-1], max(2, int(ends[-1] / SPACING)))
    return np.stack([np.interp(at, ends, path[:, axis]) for axis in (0, 1)], axis=1)


def request(space: GridSpace, seed: int) -> NDArray:
    """Draw start and goal (2, 2): cell centres of the largest part, far from each other."""
    rng = np.random.default_rng(seed)
    rows, columns = np.nonzero(space.largest_component())
    diagonal = np.hypot(np.ptp(rows), np.ptp(columns))
    while True:
        pair = rng.integers(len(rows), size=2)
        if np.hypot(*np.diff([rows[pair], columns[pair]])[:, 0]) >= LEAST_APART * diagonal:
            return space.cell_centres(rows[pair], columns[pair])


@cache
def space_of(name: str) -> GridSpace:
    """Return the space of the robot on a map."""
    occupancy = _occupancy(name)
    return GridSpace.from_occupancy(
        occupancy.data, occupancy.resolution, occupancy.origin, robot_radius=ROBOT_RADIUS
    )


def _occupancy(name: str) -> OccupancyMap:
    kind, _, seed = name.partition(' ')
    return building(int(seed)) if kind == 'floor' else load_map(name)


def figure(results: Results) -> Figure:
    """Draw the mean clearance and the near part of the paths, as found and shortened."""
    drawn = new_figure(10.0, 4.0)
    panels = drawn.subplots(1, 2)
    planners = _planners(results)
    for axes, measure, title, unit in zip(
        panels,
        ('mean', 'near'),
        ('Mean distance to the nearest obstacle', f'Part of the path within {NEAR} m of one'),
        ('past the robot\u2019s radius [m]', 'part of the length'),
        strict=True,
    ):
        draw_bars(
            axes,
            [_words(*planner) for planner in planners],
            [
                (shape, [_of(results, planner).mean(f'{shape}_{measure}') for planner in planners])
                for shape in SHAPES
            ],
            [LOOKS[algorithm].colour for algorithm, _ in planners],
        )
        style(axes, title, unit, '')
        axes.grid(False, axis='y')
    panels[1].set_yticklabels([])
    legend(panels[1], 'lower right')
    return drawn


def tables(results: Results) -> str:
    """Return the measures of every planner, over all maps and on each."""
    header = ['planner', 'mean', 'near', 'length', 'mean', 'near', 'length']
    words = (
        'As found: mean distance to the nearest obstacle past the robot\u2019s radius [m], part '
        f'of the length within {NEAR} m of one, length [m]; then the same, shortened.\n'
    )
    parts = [words]
    for name, chosen in [('all maps', results)] + [
        (Path(name).stem, results.where(place=name)) for name in results.distinct('place')
    ]:
        rows = [
            [
                _words(*planner),
                *(
                    _of(chosen, planner).mean(f'{shape}_{measure}')
                    for shape in SHAPES
                    for measure in ('mean', 'near', 'length')
                ),
            ]
            for planner in _planners(chosen)
        ]
        parts.append(f'## {name}\n\n{markdown(header, rows)}')
    return '\n'.join(parts)


def _planners(results: Results) -> list[tuple[str, float]]:
    return list(
        dict.fromkeys(
            zip(results['algorithm'].tolist(), results['clearance'].tolist(), strict=True)
        )
    )


def _of(results: Results, planner: tuple[str, float]) -> Results:
    algorithm, clearance = planner
    return results.where(algorithm=algorithm, clearance=clearance)


def _words(algorithm: str, clearance: float) -> str:
    label = LOOKS[algorithm].label
    return f'{label}, clearance={clearance}' if clearance else label


EXPERIMENT = Experiment(
    name='safety',
    about='Distance to obstacles along the paths of different planners.',
    runs=100,
    cases=cases,
    run=run,
    figure=figure,
    tables=tables,
)
