"""
The fastest way for a car to drive along a path of arcs and straight lines.

Between two changes of direction the speed rises at the largest acceleration, keeps at the largest
speed, and falls in time to rest: no other profile within the limits takes less time.
"""

import itertools
import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.poses.motion import orbit_poses
from hnr_planner.core.systems.car import Car, SPEED
from hnr_planner.core.systems.trajectory import Trajectory
import numpy as np


class Profile(NamedTuple):
    """
    Speeds along a way from a speed to rest.

    Attributes
    ----------
    begin : float
        Speed at the begin [m/s].
    top : float
        Largest speed on the way [m/s].
    length : float
        Length of the way [m].
    acceleration : float
        Largest change of speed in a second [m/s^2].

    """

    begin: float
    top: float
    length: float
    acceleration: float

    @property
    def changes(self) -> tuple[float, float]:
        """Lengths [m] along the way at which the speed stops rising, and begins to fall."""
        twice = 2.0 * self.acceleration
        risen = (self.top**2 - self.begin**2) / twice
        return risen, max(self.length - self.top**2 / twice, risen)

    def at(self, along: float) -> float:
        """Return the speed after a length [m]."""
        risen = self.begin**2 + 2.0 * self.acceleration * along
        falling = 2.0 * self.acceleration * max(self.length - along, 0.0)
        return min(math.sqrt(risen), self.top, math.sqrt(falling))


def profile_to_rest(system: Car, speed: float, length: float) -> Profile | None:
    """Return the fastest profile from a speed to rest after a length; None if it is too short."""
    twice = 2.0 * system.max_acceleration
    if speed**2 > twice * length:
        return None
    top = min(math.sqrt((twice * length + speed**2) / 2.0), system.max_speed)
    return Profile(speed, max(top, speed), length, system.max_acceleration)


def drive_along(system: Car, start: Floats, twists: Floats) -> Trajectory | None:
    """
    Return the fastest trajectory along a path, from a state to rest at the end.

    Parameters
    ----------
    system : Car
        Its limits.
    start : (4,)
        State at the begin of the path.
    twists : (m, 3)
        Motions (way, 0, turn) [m, m, rad] of the path; a way below 0 is driven backwards.

    Returns
    -------
    Trajectory or None
        None where the car is too fast at the start for the first piece of the path, or moves in
        the opposite direction.

    """
    driven = twists[twists[:, 0] != 0.0]
    states, speed = [start], float(start[SPEED])
    durations: list[float] = []
    controls: list[tuple[float, float]] = []
    if len(driven) == 0:
        return _stay(system, start) if speed == 0.0 else None
    for way, piece in itertools.groupby(driven, key=lambda twist: float(np.sign(twist[0]))):
        motions = np.array(list(piece))
        profile = profile_to_rest(system, way * speed, float(np.abs(motions[:, 0]).sum()))
        if way * speed < 0.0 or profile is None:
            return None
        begin = 0.0
        for motion in motions:
            _drive_motion(profile, begin, motion, states, durations, controls)
            begin += abs(float(motion[0]))
        states[-1][SPEED] = speed = 0.0
    times = np.append(0.0, np.cumsum(durations))
    return Trajectory(system, times, np.array(states), np.array(controls))


def _drive_motion(
    profile: Profile,
    begin: float,
    motion: Floats,
    states: list[Floats],
    durations: list[float],
    controls: list[tuple[float, float]],
) -> None:
    """Append the steps of one motion (3,) that begins after a length of the profile's way."""
    way, curvature = math.copysign(1.0, motion[0]), float(motion[2] / motion[0])
    length, first = abs(float(motion[0])), states[-1]
    ends = [at - begin for at in profile.changes if 0.0 < at - begin < length]
    before, done = profile.at(begin), 0.0
    for end in [*ends, length]:
        after = profile.at(begin + end)
        if end == done or before + after == 0.0:
            continue
        duration = 2.0 * (end - done) / (before + after)
        pose = orbit_poses(first[:3].copy(), motion, np.array([end / length]))[0]
        heading = first[2] + motion[2] * end / length
        states.append(np.array([pose[0], pose[1], heading, way * after]))
        durations.append(duration)
        limit = profile.acceleration
        pull = min(max((after - before) / duration, -limit), limit)
        controls.append((way * pull, curvature))
        before, done = after, end


def _stay(system: Car, start: Floats) -> Trajectory:
    """Return a trajectory of one step of 0 s at the start."""
    control = np.zeros((1, system.control_dim))
    return Trajectory(system, np.zeros(2), np.stack([start] * 2), control)
