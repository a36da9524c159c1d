"""The search that a roadmap returns: it is solved when it starts."""

from dataclasses import dataclass
from typing import ClassVar

from hnr_planner.core.checks import Floats
import numpy as np
from numpy.typing import NDArray


@dataclass
class SolvedSearch:
    """
    A search solved by the roadmap, without a transition.

    Attributes
    ----------
    path : (m, dim)
        Path from start to goal, kernel frame.
    taut : bool
        Whether the path is taut already, so that it is not shortened.
    lower_bound : float
        Lower bound on the length of free paths from start to goal, kernel frame; 0 where none is
        known.

    """

    path: Floats
    taut: bool
    lower_bound: float = 0.0
    iterations: ClassVar[int] = 0
    solved: ClassVar[bool] = True

    @property
    def samples(self) -> Floats:
        """Vertices (m, dim) of the path, kernel frame."""
        return self.path

    @property
    def parents(self) -> NDArray[np.int64]:
        """Index (m,) of the vertex before each vertex of the path; -1 for the start."""
        return np.arange(-1, len(self.path) - 1)

    @property
    def counts(self) -> dict[str, int]:
        """Further counts by name: an empty dict, since a roadmap has none."""
        return {}

    def advance(self, n_iterations: int) -> None:
        """Do nothing: the search is solved."""
