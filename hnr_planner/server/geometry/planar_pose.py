"""Poses in the plane."""

from typing import NamedTuple


class PlanarPose(NamedTuple):
    """A pose in the plane, in the frame of the map: position x, y [m] and yaw [rad]."""

    x: float
    y: float
    yaw: float

    def __str__(self) -> str:
        """Return the pose as text: (x, y) [m] and yaw [rad], rounded."""
        return f'({self.x:.4g}, {self.y:.4g}), yaw {self.yaw:.3g}'
