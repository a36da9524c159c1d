"""A trajectory: the states of a system over time, and the controls between the states."""

from collections.abc import Sequence
from dataclasses import dataclass
import itertools

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.systems.primitives import propagated
from hnr_planner.core.systems.system import System
import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False)
class Trajectory:
    """
    States at times that never decrease, and the control that leads from each state to the next.

    Attributes
    ----------
    system : System
        The robot.
    times : (m,)
        Times of the states [s], never decreasing; the first is 0.
    states : (m, state_dim)
        Caller's units. Each state follows from the state before under the control between the two.
        The exception: where an inelastic boundary stops the robot, the next state is at rest.
    controls : (m - 1, control_dim)
        Row ``k`` is constant from ``times[k]`` to ``times[k + 1]``.

    """

    system: System
    times: Floats
    states: Floats
    controls: Floats

    def __repr__(self) -> str:
        return (
            f'<Trajectory of a {type(self.system).__name__}: {self.duration:.6g} s, '
            f'{len(self.controls)} steps>'
        )

    @property
    def duration(self) -> float:
        """Time from the first state to the last [s]."""
        return float(self.times[-1])

    @property
    def positions(self) -> Floats:
        """Positions (m, dim) at ``times``; the curve between them is not straight."""
        return self.states[:, : self.system.dim].copy()

    @property
    def length(self) -> float:
        """Length of the curve of positions [m]."""
        steps = self.states[:-1], self.controls, np.diff(self.times)
        return float(self.system.lengths(*steps).sum())

    def at(self, times: ArrayLike) -> Floats:
        """Return the states (k, state_dim) at times (k,) [s] clamped to [0, ``duration``]."""
        wanted = np.clip(np.atleast_1d(np.asarray(times, dtype=np.float64)), 0.0, self.duration)
        steps = np.searchsorted(self.times, wanted, side='right') - 1
        states = self.states[steps]
        inside = (steps < len(self.controls)) & (wanted > self.times[steps])
        rows = steps[inside]
        after = wanted[inside] - self.times[rows]
        states[inside] = propagated(
            self.system.data, self.states[rows], self.controls[rows], after
        )
        return states


def join_trajectories(trajectories: Sequence[Trajectory]) -> Trajectory:
    """
    Return one trajectory that runs through trajectories of one system in order.

    Parameters
    ----------
    trajectories : sequence of Trajectory
        At least one. Each begins in the state that the trajectory before ends in. A trajectory of
        0 s adds no steps; if all last 0 s, the first is returned as a copy.

    Raises
    ------
    RequestError
        When the sequence is empty, or a trajectory does not begin in the state that the one before
        ends in.

    """
    if not trajectories:
        raise RequestError('trajectories must be at least one, got none')
    for k, (one, other) in enumerate(itertools.pairwise(trajectories), 1):
        if not np.array_equal(one.states[-1], other.states[0]):
            raise RequestError(
                f'trajectory {k} must begin in the state that the one before ends in, '
                f'{one.states[-1].tolist()}, got {other.states[0].tolist()}'
            )
    moving = [each for each in trajectories if each.duration > 0.0] or [trajectories[0]]
    begins = itertools.accumulate((each.duration for each in moving), initial=0.0)
    times = [begin + each.times[1:] for begin, each in zip(begins, moving, strict=False)]
    return Trajectory(
        moving[0].system,
        np.concatenate([[0.0], *times]),
        np.concatenate([moving[0].states[:1], *(each.states[1:] for each in moving)]),
        np.concatenate([each.controls for each in moving]),
    )
