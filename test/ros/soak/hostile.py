"""Requests and maps that nobody should send, from a generator with a seed."""

from __future__ import annotations

import array
from collections.abc import Sequence
import math
from test.ros.harness import grid_message
from test.ros.soak.judge import World
from typing import Any

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetPlan
import numpy as np

NUMBERS = (
    *(math.nan, math.inf, -math.inf, 0.0, -0.0, 5e-324, -5e-324, 1e-300, 1e-9, 1.0, -1.0, 7.0),
    *(1e9, -1e9, 1e16, 2.0**31, 2.0**63, 1e300, 1.7976931348623157e308, -1.7976931348623157e308),
)

#: The same in the range of single precision.
SINGLES = (math.nan, math.inf, -math.inf, 0.0, -0.0, 1e-45, 1e-4, 0.05, 0.1, 1.0, -1.0, 1e3, 3e38)

FRAMES = ('', 'map', '/map', 'map ', 'odom', 'карта', 'x' * 10_000, "'; DROP TABLE", '{}', '%s%n')
MOST_CELLS = 40


class Generator:
    """Draws hostile things; enough of each is as it should be to get past the first check."""

    def __init__(self, seed: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._hostility = 0.0

    def request(self, world: World) -> GetPlan.Request:
        """Return a request, more or less about a map; some are quite in order."""
        self._hostility = self._one_of((0.0, 0.05, 0.2))
        tolerance = self._one_of(SINGLES) if self._maybe(self._hostility) else 0.0
        return GetPlan.Request(
            start=self._pose(world), goal=self._pose(world), tolerance=tolerance
        )

    def occupancy(self) -> OccupancyGrid:
        """Return a map that may or may not make sense."""
        rows, columns = self._rng.integers(1, MOST_CELLS, 2)
        data = self._rng.choice([100, -1, 64, 65, 127, -128], (rows, columns))
        data[self._rng.random(data.shape) < 0.8] = 0
        origin = [
            *self._rng.choice([0.0, 1.5, -3.5, 7e3, -1e9], 2, p=[0.3, 0.2, 0.2, 0.2, 0.1]),
            self._rng.uniform(-4.0, 4.0),
        ]
        message = grid_message(data.astype(np.int8), 0.1, (*map(float, origin),))
        return self._spoilt(message) if self._maybe(0.5) else message

    def _spoilt(self, message: OccupancyGrid) -> OccupancyGrid:
        """Change some of the fields that say how to read the cells."""
        if self._maybe(0.2):
            message.info.width = int(self._one_of((0, 1, 39, 65_536, 2**32 - 1)))
        if self._maybe(0.2):
            message.info.height = int(self._one_of((0, 1, 39, 65_536, 2**32 - 1)))
        if self._maybe(0.2):
            message.info.resolution = self._one_of(SINGLES)
        if self._maybe(0.1):
            message.data = array.array('b')
        if self._maybe(0.2):
            message.header.frame_id = self._one_of(FRAMES)
        if self._maybe(0.2):
            message.info.origin.position.x = self._one_of(NUMBERS)
        if self._maybe(0.2):
            turn = message.info.origin.orientation
            turn.x, turn.y, turn.z, turn.w = (self._one_of(NUMBERS) for _ in range(4))
        return message

    def _pose(self, world: World) -> PoseStamped:
        pose = PoseStamped()
        pose.header.frame_id = (
            self._one_of(FRAMES) if self._maybe(self._hostility) else world.frame
        )
        if self._maybe(self._hostility):
            pose.header.stamp.sec = int(self._one_of((1, -1, 2**31 - 1, -(2**31))))
        place, turn = pose.pose.position, pose.pose.orientation
        place.x, place.y = self._point(world)
        if self._maybe(self._hostility):
            place.x = self._one_of(NUMBERS)
        if self._maybe(self._hostility):
            place.z = self._one_of(NUMBERS)
        if self._maybe(self._hostility):
            turn.x, turn.y, turn.z, turn.w = (self._one_of(NUMBERS) for _ in range(4))
        return pose

    def _point(self, world: World) -> tuple[float, float]:
        """Return a point on the map, or just outside."""
        rows, columns = world.data.shape
        x, y = self._rng.uniform(-0.05, 1.05, 2) * (columns, rows) * world.resolution
        cos, sin = math.cos(world.origin[2]), math.sin(world.origin[2])
        return (
            float(world.origin[0] + cos * x - sin * y),
            float(world.origin[1] + sin * x + cos * y),
        )

    def _maybe(self, chance: float) -> bool:
        return bool(self._rng.random() < chance)

    def _one_of(self, choices: Sequence) -> Any:
        return choices[self._rng.integers(len(choices))]
