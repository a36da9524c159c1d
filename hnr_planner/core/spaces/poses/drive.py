"""
Drives: the twists that a robot can hold, and the law by which a walk draws them.

- ``car``: ahead and back, along lines and arcs of at least a least radius;
- ``differential``: ahead and back, and turning in place;
- ``omnidirectional``: in any direction, and turning in place.
"""

from dataclasses import dataclass
import math
from typing import Any

from hnr_planner.core.checks import check_choice, check_real
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import inlined
from hnr_planner.core.kernels.streams import uniform

#: Names of the drives; the number of a drive in kernels is its index.
DRIVES = ('car', 'differential', 'omnidirectional')
CAR, DIFFERENTIAL, OMNIDIRECTIONAL = range(3)


@dataclass(frozen=True)
class Drive:
    """
    The twists that a robot can hold.

    Attributes
    ----------
    name : str
        One of ``DRIVES``.
    min_turning_radius : float
        Radius of the tightest arc [m]; 0 where the robot turns in place.
    reverse : bool
        Whether the robot drives backwards.

    """

    name: str
    min_turning_radius: float
    reverse: bool

    @property
    def number(self) -> int:
        """Number of the drive in kernels."""
        return DRIVES.index(self.name)


def check_drive(drive: Any, min_turning_radius: Any, reverse: Any) -> Drive:
    """
    Return a validated drive, or raise SpaceError.

    A car needs a turning radius above 0; the other drives turn in place and have none. A robot
    that drives in any direction cannot be forbidden to drive backwards.
    """
    try:
        name = check_choice('drive', drive, DRIVES)
    except ValueError as error:
        raise SpaceError(str(error)) from None
    radius = check_real('min_turning_radius', min_turning_radius, SpaceError)
    if not 0.0 <= radius < math.inf:
        raise SpaceError(f'min_turning_radius must be at least 0 and finite, got {radius!r}')
    if name == 'car' and radius == 0.0:
        raise SpaceError('min_turning_radius must be above 0 for a car, got 0.0')
    if name != 'car' and radius > 0.0:
        raise SpaceError(
            f'min_turning_radius must be 0 for a {name} drive, which turns in place, '
            f'got {radius!r}'
        )
    if name == 'omnidirectional' and not reverse:
        raise SpaceError('reverse must be true for an omnidirectional drive, got false')
    return Drive(name, radius, bool(reverse))


@inlined
def draw_twist(drive, max_curvature, reach, rng, u):
    """
    Write a twist that a drive can hold into ``u`` (3,), drawn without regard to the pose.

    The farthest point of the footprint, ``reach`` from the origin, moves by about one unit of
    length in a unit of time.

    - A car drives straight with probability 1/2, else along an arc whose curvature is uniform up
      to ``max_curvature``, to both sides.
    - The other drives turn in place with probability 1/2, else drive straight: ahead, or in a
      uniform direction if they are omnidirectional.
    """
    u[0], u[1], u[2] = 1.0, 0.0, 0.0
    other = uniform(rng) < 0.5
    if drive == CAR:
        if other:
            u[2] = max_curvature * (2.0 * uniform(rng) - 1.0)
    elif other:
        u[0], u[2] = 0.0, 1.0 / reach
    elif drive == OMNIDIRECTIONAL:
        angle = math.pi * uniform(rng)
        u[0], u[1] = math.cos(angle), math.sin(angle)
