"""
What an answer has to be, by a judge that shares no code with the planner.

Free cells and their parts come from the definition (``test.brute_force``) and from scipy; a path
that was given is held against every blocked cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
import math
from test.brute_force import blocked_cells, path_collisions
from test.ros.harness import points_of

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path as PathMessage
from nav_msgs.srv import GetPlan
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

SOLVED = 'SOLVED'


@dataclass(frozen=True, eq=False)
class World:
    """A map that the planner has, with its origin and frame."""

    data: NDArray[np.int8]
    resolution: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    frame: str = 'map'

    @cached_property
    def blocked(self) -> NDArray[np.bool_]:
        """Return which cells may not be entered."""
        unknown = (self.data < 0) | (self.data > 100)
        occupied = (self.data >= 65) & ~unknown
        return blocked_cells(occupied, self.resolution, 0.0, unknown)

    def expected(self, request: GetPlan.Request) -> str:
        """Return the name of the outcome that a request on this map must have."""
        start, goal = request.start.pose, request.goal.pose
        numbers = [*_numbers(request.start), *_numbers(request.goal), request.tolerance]
        turned = any(_quaternion(request.goal))
        stamps = [end.header.stamp.sec for end in (request.start, request.goal)]
        if not all(map(math.isfinite, numbers)) or not turned or request.tolerance < 0.0:
            return 'BAD_REQUEST'
        if min(stamps) < 0:
            return 'BAD_REQUEST'
        frames = {request.start.header.frame_id, request.goal.header.frame_id}
        if frames - {'', self.frame}:
            return 'BAD_FRAME'
        first, last = (self._part(p.position.x, p.position.y) for p in (start, goal))
        if first == 0:
            return 'INVALID_START'
        if last == 0:
            return 'INVALID_GOAL'
        return SOLVED if first == last else 'UNREACHABLE'

    def complaints(self, request: GetPlan.Request, path: PathMessage) -> list[str]:
        """Return what is wrong with a path that was given, in words."""
        points, found = points_of(path), []
        for name, point, end in (
            ('start', points[0], request.start),
            ('goal', points[-1], request.goal),
        ):
            asked = [end.pose.position.x, end.pose.position.y]
            if point.tolist() != asked:
                found.append(f'the {name} is {point.tolist()}, asked for was {asked}')
        if path.header.frame_id != self.frame:
            found.append(f"the frame is '{path.header.frame_id}'")
        return found + path_collisions(points, self.blocked, self.resolution, self.origin)

    @cached_property
    def _parts(self) -> NDArray[np.int32]:
        """Return the number of each cell's free part, 0 for a blocked cell."""
        parts, _ = ndimage.label(~self.blocked)
        return parts

    def _part(self, x: float, y: float) -> int:
        """Return the number of the free part that a point lies in, 0 for none."""
        cos, sin = math.cos(self.origin[2]), math.sin(self.origin[2])
        x, y = x - self.origin[0], y - self.origin[1]
        column, row = (cos * x + sin * y) / self.resolution, (cos * y - sin * x) / self.resolution
        rows, columns = self._parts.shape
        if not (0.0 < row < rows and 0.0 < column < columns):
            return 0
        return int(self._parts[int(row), int(column)])


def _numbers(stamped: PoseStamped) -> list[float]:
    place = stamped.pose.position
    return [place.x, place.y, place.z, *_quaternion(stamped)]


def _quaternion(stamped: PoseStamped) -> list[float]:
    turn = stamped.pose.orientation
    return [turn.x, turn.y, turn.z, turn.w]
