"""Store what the client received for one request in a file, from which the demo reads it."""

from __future__ import annotations

from dataclasses import dataclass
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

#: Algorithms of the requests, and their names in the picture.
ALGORITHMS = {'hit_and_run': 'Hit-and-Run', 'rrt': 'RRT'}


@dataclass(frozen=True, eq=False)
class Answer:
    """
    Service response and topic messages that the client received for one request.

    Attributes
    ----------
    outcome : str
        Name of the outcome, such as SOLVED.
    values : dict
        Values of the message on the topic ``outcome``, as text, by name.
    response : (m, 2)
        Points of the path in the response of the service [m]; (0, 2) for an empty path.
    path, samples, parents : (m, 2), (k, 2), (k,)
        Contents of the topics: points [m], and the row in ``samples`` of each sample's parent,
        -1 for a root. They are empty unless the outcome is SOLVED.
    round_trip : float
        Time from the request to the response of the service [s].

    """

    outcome: str
    values: dict[str, str]
    response: NDArray[np.float64]
    path: NDArray[np.float64]
    samples: NDArray[np.float64]
    parents: NDArray[np.int64]
    round_trip: float

    def write(self, folder: Path, algorithm: str) -> None:
        """Write the answer into a folder, in an ``.npz`` file named after the algorithm."""
        words = {'outcome': self.outcome, 'values': self.values, 'round_trip': self.round_trip}
        np.savez(
            folder / f'{algorithm}.npz',
            words=json.dumps(words),
            response=self.response,
            path=self.path,
            samples=self.samples,
            parents=self.parents,
        )

    @classmethod
    def read(cls, folder: Path, algorithm: str) -> Answer:
        """Read the answer to an algorithm's request from the folder that ``write`` wrote to."""
        with np.load(folder / f'{algorithm}.npz') as file:
            arrays = {name: file[name] for name in ('response', 'path', 'samples', 'parents')}
            return cls(**json.loads(str(file['words'])), **arrays)
