"""Choose the request of the demo: map, radius of the robot, start and goal."""

from __future__ import annotations

from dataclasses import dataclass
import os
from pathlib import Path

from hnr_planner.core import GridSpace, HnrError
from hnr_planner.maps import load_map, OccupancyMap
import numpy as np
from numpy.typing import NDArray

#: The map of the package.
OFFICE = Path('config', 'maps', 'office.yaml')
#: Radius of the robot [m].
ROBOT_RADIUS = 0.22
#: A robot fits a map when it can reach this fraction of the cells that a point could reach.
LARGE_ENOUGH = 0.5
#: Largest distance that start and goal keep from blocked cells, where there is room [cells].
ROOM_AROUND = 10

Point = tuple[float, float]


class SceneError(HnrError, ValueError):
    """Error that nothing can be planned on a map, or that the map of the package is missing."""


@dataclass(frozen=True)
class Scene:
    """
    Scene of the demo: map, free space of the robot on it, start and goal.

    ``file`` is the map's file; ``start`` and ``goal`` are (x, y) in the map frame [m].
    """

    file: Path
    occupancy: OccupancyMap
    space: GridSpace
    start: Point
    goal: Point

    @property
    def robot_radius(self) -> float:
        """Radius of the robot [m]."""
        return self.space.robot_radius


def choose_scene(file: Path) -> Scene:
    """
    Choose the scene on a map file, with the robot's radius, the start and the goal.

    Start and goal are far apart in the largest component of the free space. The robot's radius is
    0.22 m where the cells are no larger than that, and where the robot reaches at least half as
    many cells as a point does; else 0.

    Raises
    ------
    MapFileError, SceneError
        When the map cannot be read, or its largest component has fewer than two cells.

    """
    occupancy = load_map(file)
    space = _space_that_fits(occupancy)
    component = space.largest_component()
    if component.sum() < 2:
        raise SceneError(f'{file}: the map has no free space to plan in')
    first, last = farthest_cells(component)
    start, goal = space.cell_centres(*np.transpose([first, last]))
    return Scene(file, occupancy, space, (*start.tolist(),), (*goal.tolist(),))


def office_file() -> Path:
    """
    Return the office map of the package, in the source folder or where it is installed.

    SceneError is raised where there is no such file.
    """
    package = Path(__file__).resolve().parents[1]
    installed = Path('share', 'hnr_planner', OFFICE)
    prefixes = [Path(p) for p in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep) if p]
    candidates = [package.parent / OFFICE]
    candidates += [prefix / installed for prefix in (*package.parents, *prefixes)]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    raise SceneError(f'{OFFICE} is neither beside the package {package} nor installed with it')


def farthest_cells(free: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """
    Return two cells [row, column] whose shortest path through connected free cells is long.

    ``free`` (rows, cols) is one connected component. The first cell is the farthest from an
    arbitrary cell, the second the farthest from the first. Both are up to ``ROOM_AROUND`` cells
    away from cells that are not free, as long as at least half of the free cells are so far away.
    """
    inside = free
    for _ in range(ROOM_AROUND):
        smaller = _without_rim(inside)
        if smaller.sum() < free.sum() / 2:
            break
        inside = smaller
    middle = np.argwhere(inside)[0]
    first = _farthest(free, middle, inside)
    return first, _farthest(free, first, inside)


def _space_that_fits(occupancy: OccupancyMap) -> GridSpace:
    """Return the free space of a robot of ``ROBOT_RADIUS``, or else that of a point."""
    point, robot = (
        GridSpace.from_occupancy(
            occupancy.data, occupancy.resolution, occupancy.origin, robot_radius=radius
        )
        for radius in (0.0, ROBOT_RADIUS)
    )
    # Cells larger than the robot cannot resolve what it fits through.
    is_fine = occupancy.resolution <= ROBOT_RADIUS
    fits = robot.largest_component().sum() >= LARGE_ENOUGH * point.largest_component().sum()
    return robot if is_fine and fits else point


def _without_rim(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the cells of a set (rows, cols) all of whose eight neighbours belong to the set."""
    padded = np.pad(cells, 1)
    rows, cols = cells.shape
    inside = cells.copy()
    for row in range(3):
        for col in range(3):
            inside &= padded[row:, col:][:rows, :cols]
    return inside


def _farthest(
    free: NDArray[np.bool_], source: NDArray[np.int64], wanted: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """
    Return the wanted cell [row, column] that a wavefront from the source reaches last.

    The wavefront passes from a free cell to its four free neighbours; where it reaches no wanted
    cell, the source is returned.
    """
    padded = np.pad(free, 1)
    width = padded.shape[1]
    unseen, wanted_flat = padded.ravel(), np.pad(wanted, 1).ravel()
    wave = np.array([(source[0] + 1) * width + source[1] + 1])
    last = wave[0]
    while wave.size:
        unseen[wave] = False
        hits = wave[wanted_flat[wave]]
        last = hits[0] if hits.size else last
        around = (wave[:, None] + np.array([1, -1, width, -width])).ravel()
        wave = np.unique(around[unseen[around]])
    return np.array(divmod(int(last), width)) - 1
