"""The poses of a robot that is not round, on an occupancy grid, as a space."""

from functools import cached_property
import math
from typing import ClassVar

from hnr_planner.core.checks import check_direction, check_point, check_points, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.clearance import path_clearance
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.poses.data import motion_is_free, pose_data, PoseData
from hnr_planner.core.spaces.poses.disc import Disc, largest_disc
from hnr_planner.core.spaces.poses.drive import check_drive, Drive
from hnr_planner.core.spaces.poses.footprint import check_footprint, prepare_footprint
from hnr_planner.core.spaces.poses.frame import (
    pose_frame,
    PoseFrame,
    poses_from_cells,
    poses_to_cells,
)
from hnr_planner.core.spaces.poses.motion import orbit_poses
from hnr_planner.core.spaces.primitives import chord_or_empty
from hnr_planner.core.spaces.space import Chord, Space
import numpy as np
from numpy.typing import ArrayLike


class PoseSpace(Space):
    """
    The poses (x, y, yaw) at which a footprint touches no occupied cell of a grid.

    A direction is a *twist* (vx, vy, omega): a velocity [m/s, m/s, rad/s] in the robot's own
    frame. Held for a time it moves the robot along a line, on the spot, or along an arc, and a
    chord is the largest interval of times, around 0, in which the whole footprint stays free all
    the way. It is exact: nothing is tested in steps, and no angle is rounded.

    Occupied cells are closed squares, and the footprint is a closed polygon; poses at which they
    touch, within 1e-9 of a cell, are not free. Cells count as the map has them, before inflation:
    the grid's ``robot_radius`` has no meaning here. Unknown cells block if they do in the grid,
    and so does everything outside the map.

    Parameters
    ----------
    grid : GridSpace
        The map.
    footprint : (k, 2)
        Vertices [m] of a simple polygon in the robot's frame (x ahead, y to the left), in either
        order. The frame's origin, about which the robot turns in place, may lie outside.
    drive : 'differential', 'car' or 'omnidirectional'
        How the robot moves. It holds twists (v, 0, omega): a differential drive any, a car those
        of arcs with at least ``min_turning_radius``. An omnidirectional drive holds any twist.
    min_turning_radius : float
        Least radius [m] of the arcs of a car; 0 for the other drives, which turn in place.
    reverse : bool
        Whether the robot drives backwards.

    Raises
    ------
    SpaceError
        When the footprint crosses itself, has no area or cannot fit into the map, or the drive is
        none of these.

    Attributes
    ----------
    grid : GridSpace
        The map.
    footprint : (n, 2)
        Vertices [m], counter-clockwise, without those on straight sides.
    drive : Drive
        Name, least turning radius, and whether the robot drives backwards.

    """

    dim = 3
    has_straight_lines: ClassVar[bool] = False
    data: PoseData

    def __init__(
        self,
        grid: GridSpace,
        footprint: ArrayLike,
        *,
        drive: str = 'differential',
        min_turning_radius: float = 0.0,
        reverse: bool = True,
    ) -> None:
        if not isinstance(grid, GridSpace):
            raise SpaceError(f'grid must be a GridSpace, got {grid!r}')
        self.grid = grid
        self.footprint = check_footprint(footprint)
        self.drive: Drive = check_drive(drive, min_turning_radius, reverse)
        self._check_fits()
        prepared = prepare_footprint(self.footprint / grid.resolution)
        self.data = pose_data(grid.uninflated, prepared, self.drive, grid.resolution)

    def __repr__(self) -> str:
        """Name the grid's shape, the footprint's size and the drive."""
        length, width = np.ptp(self.footprint, axis=0)
        return (
            f'PoseSpace(shape={self.grid.shape}, resolution={self.grid.resolution:g}, '
            f'footprint={length:g} x {width:g} m with {len(self.footprint)} vertices, '
            f'drive={self.drive.name!r})'
        )

    def _check_fits(self) -> None:
        """Raise SpaceError for a footprint that fits into the map at no angle."""
        rows, columns = self.grid.shape
        width, height = columns * self.grid.resolution, rows * self.grid.resolution
        gaps = self.footprint[:, None] - self.footprint
        diameter = float(np.hypot(gaps[..., 0], gaps[..., 1]).max())
        if diameter >= math.hypot(width, height):
            raise SpaceError(
                f'footprint must fit into the map of {width:g} x {height:g} m, got one of '
                f'{diameter:g} m'
            )

    # -- frames ----------------------------------------------------------------------------------

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (3,) of a box around the free poses: [m, m, rad]."""
        lower, upper = self.grid.bounds
        return np.append(lower, -math.pi), np.append(upper, math.pi)

    @cached_property
    def kernel_bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (3,) of the poses, kernel frame: [cells, cells, rad]."""
        lower, upper = self.grid.kernel_bounds
        return np.append(lower, -math.pi), np.append(upper, math.pi)

    @property
    def scale(self) -> float:
        """Metres in one unit of length of the kernel frame, which is one cell."""
        return self.grid.scale

    @cached_property
    def margin(self) -> float:
        """Distance [cells] before a chord's end at which a motion stops."""
        return self.grid.margin

    @cached_property
    def typical_clearance(self) -> float:
        """Mean Chebyshev distance [cells] from a free cell to the nearest blocked cell."""
        return self.grid.typical_clearance

    @cached_property
    def frame(self) -> PoseFrame:
        """The frame of the grid as kernels take it."""
        return pose_frame(self.grid.frame)

    def to_kernel(self, points: Floats) -> Floats:
        """Convert poses (..., 3) [m, m, rad] of the map frame to the grid's frame [cells]."""
        return poses_to_cells(self.frame, _in_rows(points)).reshape(points.shape)

    def from_kernel(self, points: Floats) -> Floats:
        """Convert poses (..., 3) of the grid's frame [cells] to the map frame [m, m, rad]."""
        return poses_from_cells(self.frame, _in_rows(points)).reshape(points.shape)

    def twists_to_kernel(self, twists: Floats) -> Floats:
        """Convert twists (..., 3) [m, m, rad] to cells; they turn with the robot, not the map."""
        return np.ascontiguousarray(twists / (self.scale, self.scale, 1.0))

    def twists_from_kernel(self, twists: Floats) -> Floats:
        """Convert twists (..., 3) in cells to [m, m, rad]."""
        return np.ascontiguousarray(twists * (self.scale, self.scale, 1.0))

    # -- free poses and motions ------------------------------------------------------------------

    def chord(self, point: ArrayLike, direction: ArrayLike) -> Chord:
        """
        Return the largest interval of times in which the robot is free on the orbit of a twist.

        Parameters
        ----------
        point : (3,)
            Pose (x, y, yaw) in the map frame.
        direction : (3,)
            Twist (vx, vy, omega) in the robot's frame.

        Returns
        -------
        Chord
            Ends of the interval, in units of the twist; both 0 where the pose is not free. A
            closed orbit that is free all the way has the ends of one turn, -pi and pi over
            ``omega``.

        Raises
        ------
        RequestError
            When the pose is not finite, or the twist is zero or not finite.

        """
        pose = check_point('pose', point, 3)
        twist = check_direction('twist', direction, 3)
        # A power of two brings the twist near length 1 without changing one bit of it.
        _, exponent = np.frexp(np.abs(twist).max())
        near_unit = self.twists_to_kernel(np.ldexp(twist, -exponent))
        lower, upper = chord_or_empty(self.data, self.to_kernel(pose), near_unit)
        return Chord(*(float(np.ldexp(s, -exponent)) for s in (lower, upper)))

    def is_motion_valid(self, start: ArrayLike, end: ArrayLike) -> bool:
        """
        Return whether the footprint is free all the way while a twist is held.

        Parameters
        ----------
        start : (3,)
            Pose (x, y, yaw) in the map frame.
        end : (3,)
            Twist (vx, vy, omega) in the robot's frame that is held for one unit of time. The zero
            twist stays at the pose.

        """
        pose, twist = check_point('pose', start, 3), check_point('twist', end, 3)
        return bool(motion_is_free(self.data, self.to_kernel(pose), self.twists_to_kernel(twist)))

    def poses_along(self, pose: ArrayLike, twist: ArrayLike, times: ArrayLike) -> Floats:
        """
        Return the poses (k, 3) that the robot passes at ``times`` (k,) while it holds a twist.

        ``pose`` and ``twist`` (3,) are as for ``chord``; times may be below 0.
        """
        begin, velocity = check_point('pose', pose, 3), check_point('twist', twist, 3)
        when = check_points('times', times, np.size(times))
        return orbit_poses(begin, velocity, when)

    @cached_property
    def disc(self) -> Disc:
        """The largest disc in the footprint, and the space of its centre."""
        return largest_disc(self.grid, self.footprint)

    def outline(self, pose: ArrayLike) -> Floats:
        """Return the vertices (n, 2) [m] of the footprint at a pose (3,), map frame."""
        x, y, yaw = check_point('pose', pose, 3)
        cos, sin = math.cos(yaw), math.sin(yaw)
        turned: Floats = self.footprint @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
        return turned

    def clearance(self, points: ArrayLike) -> Floats:
        """
        Return the distances (k,) [m] from the footprint at poses (k, 3) to the next occupied cell.

        Cells are squares, counted before inflation. The distance is 0 where the pose is not free,
        and inf where no cell is occupied.
        """
        poses = np.atleast_2d(check_points('points', points, 3))
        distances = np.zeros(len(poses))
        for k in np.flatnonzero(self.contains(poses)):
            outline = self.grid.to_kernel(self.outline(poses[k]))
            ring = np.concatenate([outline, outline[:1]])
            distances[k] = path_clearance(self.grid.walls, ring) * self.scale
        return distances

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why a pose (3,) that is not free is not."""
        from shapely import box, Polygon

        pose = check_point('pose', point, 3)
        outline = self.grid.to_cells(self.outline(pose))
        rows, columns = self.grid.shape
        low, high = outline.min(axis=0), outline.max(axis=0)
        if not ((low > 0.0).all() and high[0] < columns and high[1] < rows):
            return 'a pose at which the footprint reaches over the edge of the map'
        (left, bottom), (right, top) = low.astype(int), high.astype(int) + 1
        near = np.argwhere(self.grid.uninflated[bottom:top, left:right]) + (bottom, left)
        footprint = Polygon(outline)
        for row, column in near.tolist():
            if footprint.intersects(box(column, row, column + 1, row + 1)):
                kind = 'occupied' if self.grid.occupied[row, column] else 'unknown'
                return f'a pose at which the footprint touches the {kind} cell [{row}, {column}]'
        return 'a pose at which the footprint touches a blocked cell'


def _in_rows(poses: Floats) -> Floats:
    """Return poses (..., 3) as (k, 3), in C order, for which kernels are compiled."""
    return np.ascontiguousarray(poses).reshape(-1, 3)
