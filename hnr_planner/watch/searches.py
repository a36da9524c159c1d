"""The messages about one request, which come by several topics, put together by their stamps."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from itertools import count

import numpy as np
from numpy.typing import NDArray

#: Outcome of a request for draws, which has no path.
SAMPLED = 'SAMPLED'
#: Most requests whose messages are waited for; older ones are given up.
MOST_WAITING = 128

#: A stamp, as seconds and nanoseconds.
Stamp = tuple[int, int]


@dataclass
class Search:
    """
    What is known about one request.

    Attributes
    ----------
    stamp : (int, int)
        Stamp of all its messages.
    number : int
        Its place in the order in which outcomes came; -1 before its own has come.
    caller, status : str
        Service, action or topic that the request came by, and name of the outcome.
    values : dict
        Values of the outcome, as text by name.
    paths : list of (m, 2)
        Positions [m] along the path and its alternatives; an empty one where there is no path.

    """

    stamp: Stamp
    number: int = -1
    caller: str = ''
    status: str = ''
    values: dict[str, str] = field(default_factory=dict)
    paths: list[NDArray[np.float32]] = field(default_factory=list)

    @property
    def is_complete(self) -> bool:
        """Whether the outcome has come, and as many paths as it speaks of."""
        if self.number < 0:
            return False
        n_paths = max(1, int(self.values.get('alternatives', 1)))
        return self.status == SAMPLED or len(self.paths) >= n_paths


class Searches:
    """The newest requests; ``add_outcome`` and ``add_path`` return the one to show now, if any."""

    def __init__(self) -> None:
        self._numbers = count()
        self._waiting: OrderedDict[Stamp, Search] = OrderedDict()

    def add_outcome(
        self, stamp: Stamp, caller: str, status: str, values: dict[str, str]
    ) -> Search | None:
        """Add the outcome of a request."""
        search = self._find(stamp)
        search.number = next(self._numbers)
        search.caller, search.status, search.values = caller, status, values
        return self._if_new(search)

    def add_path(self, stamp: Stamp, points: NDArray[np.float32]) -> Search | None:
        """Add a path (m, 2) [m] of a request; the first one is its answer."""
        search = self._find(stamp)
        search.paths.append(points)
        return self._if_new(search)

    def _find(self, stamp: Stamp) -> Search:
        if stamp not in self._waiting:
            self._waiting[stamp] = Search(stamp)
            if len(self._waiting) > MOST_WAITING:
                self._waiting.popitem(last=False)
        return self._waiting[stamp]

    def _if_new(self, search: Search) -> Search | None:
        """Return a request whose messages are complete now; forget it, and what came before it."""
        if not search.is_complete:
            return None
        for stamp, other in list(self._waiting.items()):
            if 0 <= other.number <= search.number:
                del self._waiting[stamp]
        return search
