"""How much is done: a little with every run of the tests, all of it with ``make soak``."""

import os
from typing import NamedTuple


class Effort(NamedTuple):
    """Requests of each client under load, seconds of maps, hostile cases, rounds of a fault."""

    requests: int
    seconds: float
    hostile: int
    rounds: int


EFFORT = Effort(500, 600.0, 2000, 5) if 'HNR_SOAK' in os.environ else Effort(10, 2.0, 60, 1)
