"""A trajectory: what a system does over time."""

from dataclasses import dataclass

from hnr_planner.core.checks import Floats
from hnr_planner.core.systems.system import System
import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False)
class Trajectory:
    """
    States at increasing times, and the control that leads from each to the next.

    Attributes
    ----------
    system : System
        What moves.
    times : (m,)
        From 0 on [s], never decreasing.
    states : (m, state_dim)
        Caller's units. Each follows from the one before under the control between them; where the
        boundary stops a motion inelastically the state that follows is at rest instead.
    controls : (m - 1, control_dim)
        Each is constant from one time to the next.

    """

    system: System
    times: Floats
    states: Floats
    controls: Floats

    @property
    def duration(self) -> float:
        """Time from the first state to the last [s]."""
        return float(self.times[-1])

    @property
    def positions(self) -> Floats:
        """Positions (m, dim) at ``times``; the way between them is curved."""
        return self.states[:, : self.system.dim].copy()

    @property
    def length(self) -> float:
        """Length of the way [m]."""
        steps = self.states[:-1], self.controls, np.diff(self.times)
        return float(self.system.lengths(*steps).sum())

    def at(self, times: ArrayLike) -> Floats:
        """Return the states (k, state_dim) at times (k,) [s], those outside taken at the ends."""
        wanted = np.clip(np.atleast_1d(np.asarray(times, dtype=np.float64)), 0.0, self.duration)
        steps = np.searchsorted(self.times, wanted, side='right') - 1
        states = np.empty((len(wanted), self.states.shape[1]))
        for k, (step, t) in enumerate(zip(steps, wanted, strict=True)):
            if step >= len(self.controls) or t == self.times[step]:
                states[k] = self.states[step]
            else:
                after = t - self.times[step]
                states[k] = self.system.propagate(self.states[step], self.controls[step], after)
        return states
