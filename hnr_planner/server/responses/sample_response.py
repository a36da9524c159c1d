"""Responses to requests for draws (random points of the free space), as data."""

from dataclasses import dataclass

from hnr_planner.core import FreeSpaceDraws
from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.responses.response import Response
import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class SampleResponse(Response):
    """
    How a request for draws (random points of the free space) ended.

    Parameters
    ----------
    settings : Settings
        The parameters by which the points were drawn.
    draws : FreeSpaceDraws, optional
        The draws, as a single chain; None after a failure.

    """

    settings: Settings
    draws: FreeSpaceDraws | None = None

    @property
    def points(self) -> NDArray[np.float64]:
        """Points (n, 2) that were drawn, in the map's frame [m]; none after a failure."""
        return np.empty((0, 2)) if self.draws is None else self.draws.points[0]

    @property
    def n_components(self) -> int:
        """Number of connected components of the free space that the draws lie in."""
        return 0 if self.draws is None else len(np.unique(self.draws.components))

    @property
    def parents(self) -> NDArray[np.intp]:
        """
        Row (n,) in ``points`` of the draw from which the walk made the step to each draw.

        -1 for the first draw of a component, and for all where ``sample_thin`` is above 1: then
        draws are several steps apart.
        """
        if self.draws is None or self.settings.sample_thin > 1:
            return np.full(len(self.points), -1)
        return self.draws.previous[0]

    @property
    def algorithm(self) -> str:
        """Name of the random walk: the parameter ``sample_walk``."""
        return self.settings.sample_walk

    @property
    def values(self) -> dict[str, str]:
        """Published values of the request as text, by name; times in seconds."""
        values = super().values
        if self.draws is not None:
            n_steps = (len(self.points) - self.n_components) * self.settings.sample_thin
            values |= {
                'seed': str(self.draws.seed),
                'iterations': str(n_steps),
                'samples': str(len(self.points)),
                'parts': str(self.n_components),
            }
        return values
