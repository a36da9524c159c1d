"""What the client received about one request, on its way to the demo through a file."""

from __future__ import annotations

from dataclasses import dataclass
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Answer:
    """
    All that arrived about one request.

    Parameters
    ----------
    outcome : str
        Name of the outcome, such as SOLVED.
    values : dict
        The outcome's values, by name.
    response : (m, 2)
        The path in the answer of the service [m].
    path, samples, parents : (m, 2), (k, 2), (k,)
        What the topics brought: points [m], and the row of each sample's parent.
    round_trip : float
        From the request to the answer of the service [s].

    """

    outcome: str
    values: dict[str, str]
    response: NDArray[np.float64]
    path: NDArray[np.float64]
    samples: NDArray[np.float64]
    parents: NDArray[np.int64]
    round_trip: float

    def write(self, folder: Path, algorithm: str) -> None:
        """Write it to a folder, under the name of the algorithm that was asked for."""
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
        """Read what `write` wrote."""
        with np.load(folder / f'{algorithm}.npz') as file:
            arrays = {name: file[name] for name in ('response', 'path', 'samples', 'parents')}
            return cls(**json.loads(str(file['words'])), **arrays)
