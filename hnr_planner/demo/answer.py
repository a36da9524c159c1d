"""Messages that the client received for one request, passed to the demo through a file."""

from __future__ import annotations

from dataclasses import dataclass
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Answer:
    """
    Response and messages of one request.

    Attributes
    ----------
    outcome : str
        Name of the outcome, such as SOLVED.
    values : dict
        The outcome's values, by name.
    response : (m, 2)
        The path in the response of the service [m].
    path, samples, parents : (m, 2), (k, 2), (k,)
        Contents of the topics: points [m], and the row of each sample's parent.
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
        """Write the answer into a folder, under the name of its algorithm."""
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
        """Read the answer of an algorithm from a folder."""
        with np.load(folder / f'{algorithm}.npz') as file:
            arrays = {name: file[name] for name in ('response', 'path', 'samples', 'parents')}
            return cls(**json.loads(str(file['words'])), **arrays)
