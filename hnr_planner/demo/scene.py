"""What the demo asks for: a map, the size of the robot, a start and a goal."""

from __future__ import annotations

from dataclasses import dataclass
import os
from pathlib import Path

from hnr_planner.core import GridSpace, HnrError
from hnr_planner.maps import load_map, OccupancyMap
import numpy as np
from numpy.typing import NDArray

ALGORITHMS = {'hit_and_run': 'Hit-and-Run', 'rrt': 'RRT'}
"""Algorithms that are asked, and what a person calls them."""
OFFICE = Path('config', 'maps', 'office.yaml')
ROBOT_RADIUS = 0.22
LARGE_ENOUGH = 0.5
"""A robot fits a map when it keeps this share of what a point could reach."""
ROOM_AROUND = 10
"""Cells that start and goal keep to the robot's limits, if the map is wide enough for it."""

Point = tuple[float, float]


class SceneError(HnrError, ValueError):
    """There is nothing to show on this map; the message names it, and why."""


@dataclass(frozen=True)
class Scene:
    """A request to show; `space` is the map as the robot sees it, points are in metres."""

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
    Return the scene on a map file.

    Start and goal are far apart in the largest part of the map that the robot can drive. Its
    radius is 0.22 m where that leaves enough of the map, and the cells are no larger; else 0.

    Raises
    ------
    MapFileError, SceneError
        When the map cannot be read, or has no free space.

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
    """Return the office that comes with us: in the source folder, or where it is installed."""
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
    Return two cells [row, column] that are far apart on the way through connected free cells.

    From any cell to the one farthest from it, and from there to the farthest again. Cells well
    inside are taken where there are some: a robot seldom starts with its nose in a corner.
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
    """Return the space of a robot of the usual size, or of a point where that one is stuck."""
    point, robot = (
        GridSpace.from_occupancy(
            occupancy.data, occupancy.resolution, occupancy.origin, robot_radius=radius
        )
        for radius in (0.0, ROBOT_RADIUS)
    )
    # Cells larger than the robot cannot tell what it fits through: a point is all they can plan.
    is_fine = occupancy.resolution <= ROBOT_RADIUS
    fits = robot.largest_component().sum() >= LARGE_ENOUGH * point.largest_component().sum()
    return robot if is_fine and fits else point


def _without_rim(cells: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return the cells whose eight neighbours belong to the set too."""
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
    """Return the wanted cell that a wave from the source through free cells reaches last."""
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
