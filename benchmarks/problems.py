"""Maps and requests, the same for every competitor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
import os
from pathlib import Path

from benchmarks.made_maps import clutter, maze, warehouse
from hnr_planner.core import GridSpace
from hnr_planner.experiments.requests import far_pairs
from hnr_planner.maps import load_map, OccupancyMap, spiral
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

OFFICE = Path(__file__).resolve().parents[1] / 'config' / 'maps' / 'office.yaml'
#: Radius of the robot [m] on maps of its size; on others the robot is a point.
ROBOT_RADIUS = dict.fromkeys(
    ('office', 'depot', 'tb3_sandbox', 'warehouse', 'maze', 'clutter'), 0.22
)
#: Widths of the spirals' corridors [m].
WIDTHS = (2.0, 1.6, 1.2, 1.0, 0.8, 0.6, 0.4)
#: Requests on each map.
PAIRS = 20


@dataclass(frozen=True, eq=False)
class Problem:
    """
    A ready space and requests in it.

    ``requests`` is (k, 2, 2): start and goal [m] of each, in one component of the free space.
    """

    name: str
    space: GridSpace
    requests: Floats

    @property
    def is_spiral(self) -> bool:
        """Return whether it is one of the spirals."""
        return self.name.startswith('spiral')

    def with_requests(self, requests: Floats) -> Problem:
        """Return the same space with other requests."""
        return Problem(self.name, self.space, requests)

    @cached_property
    def blocked_in_kernel(self) -> NDArray[np.bool_]:
        """The blocked cells in the kernel frame, with a blocked rim: (rows + 2, columns + 2)."""
        return self.space.data.free_distance == 0


def problems(quick: bool) -> list[Problem]:
    """Build all problems, or few of them for a quick run."""
    maps = {'warehouse': warehouse(), 'maze': maze(), 'clutter': clutter()}
    maps |= {file.stem: load_map(file) for file in _files()}
    if quick:
        maps = {name: maps[name] for name in ('office', 'depot') if name in maps}
    widths = (1.6, 0.8) if quick else WIDTHS
    return [_map_problem(*named) for named in maps.items()] + [
        _spiral_problem(width) for width in widths
    ]


def _files() -> list[Path]:
    folder = os.environ.get('HNR_MAPS')
    if not folder:
        return [OFFICE]
    return [OFFICE, *sorted([*Path(folder).glob('*.yaml'), *Path(folder).glob('*.map')])]


def missing_maps() -> list[str]:
    """Return a note where HNR_MAPS adds no maps to the generated ones."""
    if len(_files()) > 1:
        return []
    return ['Maps of others: HNR_MAPS names no folder that holds any (.yaml of map_server, .map).']


def _map_problem(name: str, grid: OccupancyMap) -> Problem:
    radius = ROBOT_RADIUS.get(name, 0.0)
    space = GridSpace.from_occupancy(grid.data, grid.resolution, grid.origin, robot_radius=radius)
    return Problem(name, space, far_pairs(space, PAIRS, seed=0))


def _spiral_problem(width: float) -> Problem:
    made = spiral(width)
    space = GridSpace.from_blocked(made.blocked, made.resolution)
    # Grid search goes from cell centre to cell centre.
    columns, rows = (np.array([made.start, made.goal]) / made.resolution).astype(int).T
    return Problem(f'spiral {width:.1f}', space, space.cell_centres(rows, columns)[np.newaxis])
