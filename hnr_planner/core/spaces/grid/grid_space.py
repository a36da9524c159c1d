"""An occupancy grid as a space: free points, components, and the distance to walls."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from hnr_planner.core.checks import check_point, check_points, check_real, Floats
from hnr_planner.core.errors import RequestError, SpaceError
from hnr_planner.core.spaces.bounds import in_words
from hnr_planner.core.spaces.clearance import path_clearance, point_clearance
from hnr_planner.core.spaces.curves.curve import first_exit_on_curve
from hnr_planner.core.spaces.grid.cells import Bools, read_blocked, read_occupancy
from hnr_planner.core.spaces.grid.components import island_points, nearest_in_component
from hnr_planner.core.spaces.grid.curves import first_exit_from_grid
from hnr_planner.core.spaces.grid.fields import components, free_distance, inflate
from hnr_planner.core.spaces.grid.flood import flood_path_in_grid
from hnr_planner.core.spaces.grid.frame import decimal, GridFrame
from hnr_planner.core.spaces.grid.slabs import build_slabs, Slabs
from hnr_planner.core.spaces.grid.traversal import GridData
from hnr_planner.core.spaces.primitives import component, flood_path
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.spaces.transformed import TransformedData
import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Value of cells of a Nav2 costmap that an obstacle's inflation blocks; obstacles have 100. A
#: caller who takes cells from this value on as occupied has such a costmap.
COSTMAP_INFLATED = 99
#: Approximate number of cells in the sample for a mean over a map.
TYPICAL_CELLS = 10_000

first_exit_on_curve.register(GridData)(first_exit_from_grid)
flood_path.register(GridData)(flood_path_in_grid)


@dataclass(frozen=True, eq=False, repr=False)
class GridSpace(Space):
    """
    The free points of an occupancy grid: ``GridSpace.from_occupancy`` or ``.from_blocked``.

    Row 0 of every array is the row nearest the origin, points are (x, y) in metres in the map
    frame, and ``origin`` is the pose (x, y, yaw) of the grid in it. Blocked cells are closed and
    everything outside the grid is blocked.

    Attributes
    ----------
    frame : GridFrame
        Resolution, origin and shape.
    robot_radius : float
        Radius [m] by which the occupied cells were inflated.
    data : GridData
        The compiled grid.

    """

    frame: GridFrame
    robot_radius: float
    data: GridData = field()  # no default: the base class has a property of this name
    _wall_distance: NDArray[np.uint8]
    #: Cells that the inflation of a costmap blocks; None for a map that is no costmap.
    _costmap_inflation: Bools | None = None

    dim = 2

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
            Side of a cell [m]. A number of single precision, as a message carries it, is taken as
            the decimal that it stands for.
        origin : (x, y, yaw)
            Pose of the outer corner of cell [0, 0] in the map frame [m, m, rad].
        robot_radius : float
            A cell is blocked when its centre is within this distance [m] of the centre of an
            occupied cell. Unknown cells and the map's edge block, but are not inflated.
        occupied_threshold : int
            Cells of at least this value, 1..100, are occupied. For a costmap of Nav2 it is 99:
            then cells of 99 are known to be inflation, and those of 100 to be obstacles.
        unknown : 'blocked' or 'free'
            Whether unknown cells block or are free.

        Raises
        ------
        SpaceError
            When one of the arguments describes no grid; the message names it.

        """
        occupied, closed = read_occupancy(data, occupied_threshold, unknown)
        space = cls._build(occupied, closed, resolution, origin, robot_radius)
        if occupied_threshold == COSTMAP_INFLATED:
            space = replace(space, _costmap_inflation=np.asarray(data) == COSTMAP_INFLATED)
        return space

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
        return cls._build(occupied, np.zeros_like(occupied), resolution, origin, robot_radius)

    @classmethod
    def _build(
        cls,
        occupied: Bools,
        closed: Bools,
        resolution: float,
        origin: Iterable[float],
        radius: float,
    ) -> 'GridSpace':
        """Check what all constructors take, inflate the occupied cells and label components."""
        frame = GridFrame.checked(resolution, origin, occupied.shape)
        radius = decimal(check_real('robot_radius', radius, SpaceError))
        if not 0.0 <= radius < np.inf:
            raise SpaceError(f'robot_radius must be at least 0 and finite, got {radius!r}')
        distance = free_distance(inflate(occupied, radius / frame.resolution) | closed)
        return cls(
            frame=frame,
            robot_radius=radius,
            data=GridData(distance, components(distance > 0)),
            _wall_distance=free_distance(occupied, closed_rim=False),
        )

    def __repr__(self) -> str:
        """Name the size, the frame and the robot's radius."""
        return (
            f'GridSpace(shape={self.shape}, resolution={self.resolution:g}, '
            f'origin={in_words(np.array(self.origin))}, robot_radius={self.robot_radius:g})'
        )

    # -- frame -----------------------------------------------------------------------------------

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.frame.shape

    @property
    def resolution(self) -> float:
        """Side of a cell [m]."""
        return self.frame.resolution

    @property
    def origin(self) -> tuple[float, float, float]:
        """Pose (x, y, yaw) of the grid in the map frame [m, m, rad]."""
        return self.frame.origin

    def compiled_at(self, origin: Floats | None) -> TransformedData:
        """Return the compiled grid in the map frame moved to ``origin`` (2,); None for 0."""
        matrix, offset = self.frame.to_cells
        if origin is not None:
            offset = self.frame.to_kernel(origin)
        return TransformedData(self.data, matrix, offset)

    @cached_property
    def compiled(self) -> TransformedData:
        """The compiled grid in the map frame."""
        return self.compiled_at(None)

    @property
    def scale(self) -> float:
        """Metres in one unit of the kernel frame, which is one cell."""
        return self.frame.resolution

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (2,) [m] of a box around the grid, in the map frame."""
        corners = self.from_kernel(self.frame.corners)
        return corners.min(axis=0), corners.max(axis=0)

    @property
    def kernel_bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (2,) of the grid in the kernel frame."""
        return self.frame.corners[0], self.frame.corners[2]

    @cached_property
    def margin(self) -> float:
        """Distance from a chord's end at which one stops, never less than coordinates resolve."""
        return max(super().margin, 8.0 * self.frame.rounding)

    @cached_property
    def typical_clearance(self) -> float:
        """Mean distance in king's moves from a free cell to a blocked one, over a sample."""
        stride = max(1, int(np.sqrt(self.data.labels.size / TYPICAL_CELLS)))
        distance = self.data.free_distance[::stride, ::stride]
        free = distance[distance > 0]
        return float(free.mean()) if free.size else 1.0

    def to_kernel(self, points: Floats) -> Floats:
        """Convert points (..., 2) [m] of the map frame to the kernel frame [cells]."""
        return self.frame.to_kernel(points)

    def from_kernel(self, points: Floats) -> Floats:
        """Convert points (..., 2) of the kernel frame [cells] to the map frame [m]."""
        return self.frame.from_kernel(points)

    def turn_to_kernel(self, directions: Floats) -> Floats:
        """Rotate directions (..., 2) of the map frame into the kernel frame, unscaled."""
        return self.frame.turn_to_kernel(directions)

    def cell_centres(self, rows: ArrayLike, columns: ArrayLike) -> Floats:
        """Return the centres (k, 2) [m] of cells at ``rows`` and ``columns`` (k,), map frame."""
        cells = np.stack([np.asarray(columns), np.asarray(rows)], axis=-1)
        return self.frame.from_kernel(cells + (self.frame.RIM + 0.5))

    def to_cells(self, points: Floats) -> Floats:
        """Return (column, row) of points (..., 2) [m] of the map frame, from the grid's corner."""
        return self.frame.to_kernel(points) - self.frame.RIM

    def from_cells(self, cells: Floats) -> Floats:
        """Return points (..., 2) [m] of the map frame at (column, row) from the grid's corner."""
        return self.frame.from_kernel(cells + self.frame.RIM)

    # -- free points -----------------------------------------------------------------------------

    @property
    def blocked(self) -> Bools:
        """Cells (rows, cols) that no path may touch."""
        return self.data.free_distance[1:-1, 1:-1] == 0

    @property
    def occupied(self) -> Bools:
        """Cells (rows, cols) that the map says are occupied, before inflation."""
        return self._wall_distance[1:-1, 1:-1] == 0

    def is_obstacle(self, row: int, column: int) -> bool:
        """Return whether a cell is occupied, other than by the inflation of a costmap."""
        inflation = self._costmap_inflation
        is_inflation = inflation is not None and bool(inflation[row, column])
        return bool(self._wall_distance[row + 1, column + 1] == 0) and not is_inflation

    def inflated(self, rows: slice, columns: slice) -> Bools:
        """Return which cells of a window are near an obstacle, not in it: blocked by inflation."""
        cells = self.robot_radius / self.resolution
        reach = int(min(cells, max(self.shape))) + 1
        top, left = max(rows.start - reach, 0), max(columns.start - reach, 0)
        bottom, right = rows.stop + reach, columns.stop + reach
        occupied = self._wall_distance[1:-1, 1:-1][top:bottom, left:right] == 0
        inner = (
            slice(rows.start - top, rows.stop - top),
            slice(columns.start - left, columns.stop - left),
        )
        inflated = inflate(occupied, cells)[inner] & ~occupied[inner]
        if self._costmap_inflation is not None:
            inflated |= self._costmap_inflation[rows, columns]
        return inflated

    def reaches_to(self, point: ArrayLike) -> bool:
        """Return whether ``point`` (2,) [m] lies on the map, its edge included."""
        x, y = self.frame.to_kernel(check_point('point', point, 2)) - self.frame.RIM
        rows, columns = self.shape
        return bool(0.0 <= x <= columns and 0.0 <= y <= rows)

    def why_not_free(self, point: ArrayLike) -> str:
        """Return in words why ``point`` (2,) [m] is not free."""
        x, y = self.frame.to_kernel(check_point('point', point, 2)) - self.frame.RIM
        rows, columns = self.shape
        if not (0 < x < columns and 0 < y < rows):
            lower, upper = self.bounds
            where = 'on the edge of' if self.reaches_to(point) else 'outside'
            return (
                f'{where} the map, which spans '
                f'x {lower[0]:g}..{upper[0]:g}, y {lower[1]:g}..{upper[1]:g} m'
            )
        return self._why_not_free_in_cell(int(y), int(x))

    def _why_not_free_in_cell(self, row: int, column: int) -> str:
        """Return in words why a point in cell [row, column] is not free."""
        cell = f'cell [{row}, {column}]'
        if self.is_obstacle(row, column):
            return f'inside an obstacle: {cell} is occupied'
        if not self.blocked[row, column]:
            return f'on the edge of a blocked cell beside {cell}'
        if self._wall_distance[row + 1, column + 1] == 0:
            return f'within the inflation of the costmap around an obstacle, in {cell}'
        if self.inflated(slice(row, row + 1), slice(column, column + 1)).item():
            return f'within the robot radius of {self.robot_radius:g} m of an obstacle, in {cell}'
        return f'in unknown space: {cell} is unknown'

    # -- components ------------------------------------------------------------------------------

    def connected(self, a: ArrayLike, b: ArrayLike) -> bool:
        """
        Return whether a path joins two free points, exactly.

        Free cells that share an edge are connected; those that share only a corner are not, since
        the corner touches the two obstacles beside it.
        """
        label = self._component(check_point('a', a, 2))
        return label != 0 and label == self._component(check_point('b', b, 2))

    @property
    def components(self) -> NDArray[np.int32]:
        """Component (rows, cols) of free space that each cell belongs to; 0 where blocked."""
        return self.data.labels[1:-1, 1:-1]

    def component_of(self, point: ArrayLike) -> int:
        """Return the component that holds ``point`` (2,) [m]; 0 where it is not free."""
        return self._component(check_point('point', point, 2))

    def region_reachable(self, start: ArrayLike, goal: ArrayLike, radius: float) -> bool:
        """Return whether a path leads from ``start`` to within ``radius`` [m] of ``goal``."""
        return self.nearest_reachable(start, goal, radius) is not None

    def largest_component(self) -> Bools:
        """Return the cells (rows, cols) bool of the largest component of free space."""
        labels = self.data.labels[1:-1, 1:-1]
        sizes = np.bincount(labels.ravel())
        sizes[0] = 0
        return (labels == sizes.argmax()) & (labels > 0)

    def nearest_reachable(self, start: ArrayLike, goal: ArrayLike, radius: float) -> Floats | None:
        """
        Return the point of the start's component nearest to ``goal``; None beyond ``radius`` [m].

        Free space is open, so a nearest point on the rim of a cell is taken ``margin`` inside.
        """
        label = self._component(check_point('start', start, 2))
        target = self.frame.to_kernel(check_point('goal', goal, 2))
        if label == 0:
            return None
        nearest, offset = nearest_in_component(self.data.labels, label, target, self.margin)
        return self.frame.from_kernel(nearest) if offset <= radius / self.scale else None

    @cached_property
    def slabs(self) -> Slabs:
        """Free space as slabs, for exact shortest paths; built for the first that asks."""
        return build_slabs(self.data.free_distance)

    @cached_property
    def island_points(self) -> Floats:
        """A point (k, 2) in each blocked component that a path can go round, kernel frame."""
        return island_points(self.data.free_distance == 0)

    def _component(self, point: Floats) -> int:
        """Return the component that holds a point (2,) [m], from 1; 0 where it is not free."""
        return int(component(self.data, self.frame.to_kernel(point)))

    # -- distance to walls -----------------------------------------------------------------------

    @property
    def walls(self) -> NDArray[np.uint8]:
        """Distance (rows, columns) in king's moves to the nearest occupied cell, kernel frame."""
        return self._wall_distance

    def clearance(self, points: ArrayLike) -> Floats:
        """Return the distances (k,) [m] from points (k, 2) to occupied squares; inf for none."""
        cells = self.frame.to_kernel(np.atleast_2d(check_points('points', points, 2)))
        return point_clearance(self._wall_distance, cells) * self.scale

    def path_clearance(self, path: ArrayLike) -> float:
        """Return the least clearance [m] along the whole of a path (m, 2); inf without walls."""
        points = check_points('path', path, 2)
        if points.ndim != 2 or len(points) == 0 or not np.isfinite(points).all():
            raise RequestError(f'path must be at least one finite point (m, 2), got {path!r}')
        cells = self.frame.to_kernel(points)
        return float(path_clearance(self._wall_distance, cells)) * self.scale
