"""The compiled space of poses, and its primitives: lines are orbits of twists."""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.spaces.grid.cells import Bools
from hnr_planner.core.spaces.grid.fields import free_distance
from hnr_planner.core.spaces.lines import draw_direction, point_on_line
from hnr_planner.core.spaces.poses.contact import first_contact
from hnr_planner.core.spaces.poses.drive import draw_twist, Drive
from hnr_planner.core.spaces.poses.footprint import Footprint
from hnr_planner.core.spaces.poses.motion import moved, wrapped
from hnr_planner.core.spaces.poses.overlap import overlaps
from hnr_planner.core.spaces.primitives import chord, contains, first_exit
import numpy as np
from numpy.typing import NDArray

#: Length of a short manoeuvre of a car, in turning radii.
STRIDE = 0.6


class PoseData(NamedTuple):
    """
    A compiled space of poses (x, y, yaw): x and y in the kernel frame of a grid [cells].

    Attributes
    ----------
    free_distance : (rows, columns) uint8
        Chebyshev distance [cells] to the nearest blocked cell; 0 on the rim.
    corner_distance : (rows + 1, columns + 1) uint8
        Chebyshev distance [cells] from each grid point to the nearest corner of the blocked cells
        that can meet a side of the footprint: one where one of four cells is blocked, or two that
        lie across.
    edges, pieces, piece_ends, circle
        Those of the ``Footprint`` [cells].
    drive : int
        Number of the drive in ``DRIVES``.
    max_curvature : float
        Largest curvature of a car's arcs [1 / cells].
    reach : float
        Distance from the origin of the robot's frame to its farthest vertex [cells].
    stride : float
        Length of a short manoeuvre [cells]: the reach, or a good part of a car's turning radius.
    reverse : bool
        Whether the robot drives backwards.

    """

    free_distance: NDArray[np.uint8]
    corner_distance: NDArray[np.uint8]
    edges: Floats
    pieces: Floats
    piece_ends: NDArray[np.int64]
    circle: Floats
    drive: int
    max_curvature: float
    reach: float
    stride: float
    reverse: bool


def pose_data(blocked: Bools, footprint: Footprint, drive: Drive, resolution: float) -> PoseData:
    """
    Return the compiled space of the poses of a footprint [cells] among blocked cells.

    ``blocked`` (rows, cols) is without the rim; ``resolution`` is the side of a cell [m].
    """
    radius = drive.min_turning_radius
    return PoseData(
        free_distance(blocked),
        _corner_distance(blocked),
        footprint.edges,
        footprint.pieces,
        footprint.piece_ends,
        footprint.circle,
        drive.number,
        resolution / radius if radius > 0.0 else math.inf,
        footprint.reach,
        max(footprint.reach, STRIDE * radius / resolution),
        drive.reverse,
    )


def _corner_distance(blocked: Bools) -> NDArray[np.uint8]:
    """Return the Chebyshev distance from each grid point, rim included, to the next corner."""
    cells = np.pad(blocked, 2, constant_values=True)
    below, above = cells[:-1], cells[1:]
    here = [below[:, :-1], below[:, 1:], above[:, :-1], above[:, 1:]]
    n_blocked = sum(cell.astype(np.uint8) for cell in here)
    is_corner = (n_blocked == 1) | ((n_blocked == 2) & (here[0] == here[3]))
    return np.ascontiguousarray(free_distance(is_corner, closed_rim=False)[1:-1, 1:-1])


@contains.register(PoseData)
@kernel
def _contains(space, x):
    """Return whether the footprint at the pose ``x`` (3,) touches no blocked cell."""
    return not overlaps(
        space.free_distance, space.pieces, space.piece_ends, space.circle, x[0], x[1], x[2]
    )


@first_exit.register(PoseData)
@kernel
def _first_exit(space, x, u, t, horizon):
    """Return the first time from ``t`` on at which the footprint on an orbit is not free."""
    at_x, at_y, yaw = moved(x[0], x[1], x[2], u[0], u[1], u[2], t)
    if overlaps(
        space.free_distance, space.pieces, space.piece_ends, space.circle, at_x, at_y, yaw
    ):
        return t
    return t + first_contact_of(space, at_x, at_y, yaw, u[0], u[1], u[2], horizon - t)


@chord.register(PoseData)
@kernel
def _chord(space, x, u, back):
    """
    Return the largest free interval of the orbit of ``u`` around the pose ``x`` (3,).

    An orbit that is closed and free all the way has the interval of one turn, with the pose in the
    middle.
    """
    upper = first_contact_of(space, x[0], x[1], x[2], u[0], u[1], u[2], math.inf)
    if upper == math.inf:
        half_a_turn = math.pi / abs(u[2])
        return -half_a_turn, half_a_turn
    lower = first_contact_of(space, x[0], x[1], x[2], back[0], back[1], back[2], math.inf)
    return -lower, upper


@kernel
def first_contact_of(space, x, y, yaw, vx, vy, omega, horizon):
    """Return the time of the first contact of the footprint from a free pose, or inf."""
    return first_contact(
        space.free_distance,
        space.corner_distance,
        space.edges,
        space.circle,
        x,
        y,
        yaw,
        vx,
        vy,
        omega,
        horizon,
    )


@point_on_line.register(PoseData)
@inlined
def _point_on_line(space, x, u, s, y):
    """Write the pose after the twist ``u`` was held for ``s`` into ``y`` (3,)."""
    at_x, at_y, yaw = moved(x[0], x[1], x[2], u[0], u[1], u[2], s)
    y[0], y[1], y[2] = at_x, at_y, wrapped(yaw)


@draw_direction.register(PoseData)
@inlined
def _draw_direction(space, rng, u):
    """Write a twist that the drive can hold into ``u`` (3,)."""
    draw_twist(space.drive, space.max_curvature, space.reach, rng, u)


@kernel
def motion_is_free(space, x, u):
    """Return whether the footprint is free while ``u`` is held for one unit of time."""
    y = np.empty(3)
    y[0], y[1], y[2] = moved(x[0], x[1], x[2], u[0], u[1], u[2], 1.0)
    if not (contains(space, x) and contains(space, y)):
        return False
    return not u.any() or first_contact_of(space, x[0], x[1], x[2], u[0], u[1], u[2], 1.0) > 1.0
