"""The type of the result of ``plan_trajectory``."""

from dataclasses import dataclass

from hnr_planner.core.planning.result import SearchResult
from hnr_planner.core.systems.trajectory import Trajectory


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class TrajectoryResult(SearchResult):
    """
    Result of ``plan_trajectory``: all that a ``SearchResult`` has, and the attribute below.

    ``path`` has the positions of the trajectory at its times, between which it is curved, and
    ``length`` is the length of the curve.

    Attributes
    ----------
    trajectory : Trajectory or None
        Times, states and controls; None when no trajectory was found or it was refused as too
        long.

    """

    trajectory: Trajectory | None = None

    def __repr__(self) -> str:
        """Name status and length, count vertices and samples, and name the trajectory."""
        return f'{super().__repr__()[:-1]}, trajectory={self.trajectory!r})'
