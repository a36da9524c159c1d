"""
An occupancy grid as a space: free points, components, and the distance to walls.

The class is the front of all modules of this folder, which do the work: most of its length is
docstrings.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

from hnr_planner.core.checks import check_point, check_points, check_real, Floats
from hnr_planner.core.errors import RequestError, SpaceError
from hnr_planner.core.spaces.bounds import in_words
from hnr_planner.core.spaces.clearance import path_clearance, point_clearance
from hnr_planner.core.spaces.curves.curve import first_exit_on_curve
from hnr_planner.core.spaces.grid.cells import Bools, read_blocked, read_occupancy
from hnr_planner.core.spaces.grid.components import (
    island_points,
    largest_component,
    nearest_in_component,
)
from hnr_planner.core.spaces.grid.curves import first_exit_from_grid
from hnr_planner.core.spaces.grid.fields import components, free_distance, inflate
from hnr_planner.core.spaces.grid.frame import decimal, GridFrame
from hnr_planner.core.spaces.grid.framed_space import FramedSpace
from hnr_planner.core.spaces.grid.obstacles import costmap_inflation, Obstacles
from hnr_planner.core.spaces.grid.slabs import build_slabs, Slabs
from hnr_planner.core.spaces.grid.traversal import GridData
from hnr_planner.core.spaces.primitives import component
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Approximate number of cells in the sample for a mean over a map.
TYPICAL_CELLS = 10_000

first_exit_on_curve.register(GridData)(first_exit_from_grid)


@dataclass(frozen=True, eq=False, repr=False)
class GridSpace(FramedSpace):
    """
    The free points of an occupancy grid; build it by ``from_occupancy`` or ``from_blocked``.

    Row 0 of every array is the row nearest the origin, points are (x, y) in metres in the map
    frame, and ``origin`` is the pose (x, y, yaw) of the grid in the map frame. Blocked cells are
    closed and everything outside the grid is blocked.

    Attributes
    ----------
    frame : GridFrame
        Resolution, origin and shape.
    robot_radius : float
        Radius [m] by which the occupied cells were inflated.
    data : GridData
        The compiled grid.

    """

    robot_radius: float
    data: GridData = field()  # no default: the base class has a property of this name
    _obstacles: Obstacles

    @classmethod
    def from_occupancy(
        cls,
        data: ArrayLike,
        resolution: float,
        origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
        *,
        robot_radius: float = 0.0,
        occupied_threshold: int = 65,
        unknown: Literal['blocked', 'free'] = 'blocked',
    ) -> 'GridSpace':
        """
        Build the space of a ``nav_msgs/OccupancyGrid``.

        Parameters
        ----------
        data : (rows, cols) integers
            Occupancy: 0..100, -1 for unknown; values outside -1..100 count as unknown.
        resolution : float
            Side of a cell [m]. A number of single precision, as in a message, is replaced by its
            decimal: .05 for .05000000074505806.
        origin : (x, y, yaw)
            Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].
        robot_radius : float
            A cell is blocked when its centre is within this distance [m] of the centre of an
            occupied cell. Unknown cells and the map's edge block, but are not inflated.
        occupied_threshold : int
            Cells of at least this value, 1..100, are occupied. 99 is for a costmap of Nav2: there
            cells of 99 are inflation, and cells of 100 are obstacles.
        unknown : 'blocked' or 'free'
            Whether unknown cells are blocked or free.

        Raises
        ------
        SpaceError
            When one of the arguments describes no grid; the message names it.

        """
        occupied, closed = read_occupancy(data, occupied_threshold, unknown)
        inflation = costmap_inflation(data, occupied_threshold)
        return cls._build(occupied, closed, inflation, resolution, origin, robot_radius)

    @classmethod
    def from_blocked(
        cls,
        blocked: ArrayLike,
        resolution: float = 1.0,
        origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
        *,
        robot_radius: float = 0.0,
    ) -> 'GridSpace':
        """
        Build the space whose occupied cells are ``blocked``.

        Parameters
        ----------
        blocked : (rows, cols) bool
            The occupied cells.
        resolution : float
            Side of a cell [m].
        origin : (x, y, yaw)
            Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].
        robot_radius : float
            Radius [m] by which the occupied cells are inflated, as in ``from_occupancy``.

        Raises
        ------
        SpaceError
            When one of the arguments describes no grid; the message names it.

        """
        occupied = read_blocked(blocked)
        closed = np.zeros_like(occupied)
        return cls._build(occupied, closed, None, resolution, origin, robot_radius)

    @classmethod
    def _build(
        cls,
        occupied: Bools,
        closed: Bools,
        inflation: Bools | None,
        resolution: float,
        origin: Iterable[float],
        radius: float,
    ) -> 'GridSpace':
        """Build the space: check the arguments, inflate occupied cells, label components."""
        frame = GridFrame.checked(resolution, origin, occupied.shape)
        radius = decimal(check_real('robot_radius', radius, SpaceError))
        if not 0.0 <= radius < np.inf:
            raise SpaceError(f'robot_radius must be at least 0 and finite, got {radius!r}')
        cells = radius / frame.resolution
        distance = free_distance(inflate(occupied, cells) | closed)
        walls = free_distance(occupied, closed_rim=False)
        obstacles = Obstacles(walls, cells, inflation, closed)
        return cls(frame, radius, GridData(distance, components(distance > 0)), obstacles)

    def __repr__(self) -> str:
        """Name the shape, the resolution, the origin and the robot's radius."""
        return (
            f'GridSpace(shape={self.shape}, resolution={self.resolution:g}, '
            f'origin={in_words(np.array(self.origin))}, robot_radius={self.robot_radius:g})'
        )

    # -- free points -----------------------------------------------------------------------------

    @property
    def blocked(self) -> Bools:
        """Which cells (rows, cols) are blocked: occupied, inflated, or unknown and closed."""
        return self.data.free_distance[1:-1, 1:-1] == 0

    @property
    def occupied(self) -> Bools:
        """Which cells (rows, cols) are occupied in the map, before inflation."""
        return self._obstacles.occupied

    @property
    def uninflated(self) -> Bools:
        """
        Which cells (rows, cols) are blocked without inflation: occupied, or unknown and closed.

        Neither the inflation by the robot's radius counts nor that of a costmap.
        """
        return self._obstacles.uninflated

    def is_obstacle(self, row: int, column: int) -> bool:
        """Return whether cell [row, column] is occupied, and not as inflation in a costmap."""
        return self._obstacles.is_obstacle(row, column)

    def inflated(self, rows: slice, columns: slice) -> Bools:
        """
        Return which cells of a window of rows and columns only inflation blocks.

        The inflation is that by the robot's radius or that of a costmap. Cells [row, column] are
        counted in the map, without the rim.
        """
        return self._obstacles.inflated(rows, columns)

    def reaches_to(self, point: ArrayLike) -> bool:
        """Return whether ``point`` (2,) [m], map frame, lies in the grid, the edge included."""
        x, y = self.to_cells(check_point('point', point, 2))
        rows, columns = self.shape
        return bool(0.0 <= x <= columns and 0.0 <= y <= rows)

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (2,) [m] is not free."""
        x, y = self.to_cells(check_point('point', point, 2))
        rows, columns = self.shape
        if not (0 < x < columns and 0 < y < rows):
            lower, upper = self.bounds
            where = 'on the edge of' if self.reaches_to(point) else 'outside'
            spans = f'x {lower[0]:g}..{upper[0]:g}, y {lower[1]:g}..{upper[1]:g} m'
            return f'{where} the map, which spans {spans}'
        row, column = int(y), int(x)
        if not self.blocked[row, column]:
            return f'on the edge of a blocked cell beside cell [{row}, {column}]'
        return self._obstacles.why_blocked(row, column, self.robot_radius)

    # -- components ------------------------------------------------------------------------------

    def connected(self, a: ArrayLike, b: ArrayLike) -> bool:
        """
        Return whether a free path joins the points ``a`` and ``b`` (2,) [m], map frame, exactly.

        It is false where one of the points is not free. Free cells that share an edge are
        connected; those that share only a corner are not, since the corner touches the two
        obstacles beside it.
        """
        label = self._component(check_point('a', a, 2))
        return label != 0 and label == self._component(check_point('b', b, 2))

    @property
    def components(self) -> NDArray[np.int32]:
        """Number (rows, cols) of the component of each free cell, from 1; 0 where blocked."""
        return self.data.labels[1:-1, 1:-1]

    def component_of(self, point: ArrayLike) -> int:
        """Return the component, from 1, that holds ``point`` (2,) [m]; 0 where it is not free."""
        return self._component(check_point('point', point, 2))

    def region_reachable(self, start: ArrayLike, goal: ArrayLike, radius: float) -> bool:
        """
        Return whether a path leads from ``start`` (2,) to within ``radius`` [m] of ``goal`` (2,).

        The points are in the map frame [m]; ``goal`` need not be free. False where ``start`` is
        not free.
        """
        return self.nearest_reachable(start, goal, radius) is not None

    def largest_component(self) -> Bools:
        """Return which cells (rows, cols) are in the largest component; none if none is free."""
        return largest_component(self.components)

    def nearest_reachable(self, start: ArrayLike, goal: ArrayLike, radius: float) -> Floats | None:
        """
        Return the point (2,) [m] nearest to ``goal`` that a path from ``start`` reaches, or None.

        None is returned where ``start`` is not free, or no such point is within ``radius`` [m] of
        ``goal``. Free space is open, so the point is kept ``margin`` inside its cell.
        """
        label = self._component(check_point('start', start, 2))
        target = self.frame.to_kernel(check_point('goal', goal, 2))
        if label == 0:
            return None
        nearest, offset = nearest_in_component(self.data.labels, label, target, self.margin)
        return self.frame.from_kernel(nearest) if offset <= radius / self.scale else None

    @cached_property
    def slabs(self) -> Slabs:
        """Free cells as rectangles, kernel frame, for shortest paths; built when first used."""
        return build_slabs(self.data.free_distance)

    @cached_property
    def island_points(self) -> Floats:
        """
        One point (k, 2) in each component of blocked cells that does not touch the rim.

        The points are centres of cells in the kernel frame [cells].
        """
        return island_points(self.data.free_distance == 0)

    def _component(self, point: Floats) -> int:
        """Return the component that holds a point (2,) [m], from 1; 0 where it is not free."""
        return int(component(self.data, self.frame.to_kernel(point)))

    # -- distance to obstacles -------------------------------------------------------------------

    @property
    def walls(self) -> NDArray[np.uint8]:
        """Chebyshev distance [cells] to an occupied cell: (rows + 2, cols + 2), with the rim."""
        return self._obstacles.distance

    def clearance(self, points: ArrayLike) -> Floats:
        """
        Return the distances (k,) [m] from points (k, 2) [m] to the nearest occupied cell.

        Cells are squares, counted before inflation. The distances are inf if none is occupied.
        """
        cells = self.frame.to_kernel(np.atleast_2d(check_points('points', points, 2)))
        return point_clearance(self._obstacles.distance, cells) * self.scale

    def path_clearance(self, path: ArrayLike) -> float:
        """
        Return the least distance [m] from a path (m, 2) [m] to an occupied cell.

        Cells are squares, counted before inflation. The distance is inf if none is occupied.
        """
        points = check_points('path', path, 2)
        if points.ndim != 2 or len(points) == 0 or not np.isfinite(points).all():
            raise RequestError(f'path must be at least one finite point (m, 2), got {path!r}')
        cells = self.frame.to_kernel(points)
        return float(path_clearance(self._obstacles.distance, cells)) * self.scale

    @cached_property
    def typical_clearance(self) -> float:
        """
        Mean Chebyshev distance [cells] from a free cell to the nearest blocked cell.

        It is the mean over a regular sample of about ``TYPICAL_CELLS`` cells; 1 if none of them is
        free.
        """
        stride = max(1, int(np.sqrt(self.data.labels.size / TYPICAL_CELLS)))
        distance = self.data.free_distance[::stride, ::stride]
        free = distance[distance > 0]
        return float(free.mean()) if free.size else 1.0
