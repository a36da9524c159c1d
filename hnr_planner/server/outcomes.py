"""The names under which a request can end, and the exception that ends it early."""

import enum

from hnr_planner.core.errors import HnrError


class Outcome(enum.Enum):
    """How a request ended; where the planner decides that, the name is its status' name."""

    SOLVED = enum.auto()
    SAMPLED = enum.auto()
    NOT_ACTIVE = enum.auto()
    NO_MAP = enum.auto()
    MAP_NOT_READY = enum.auto()
    MAP_CHANGED = enum.auto()
    BAD_REQUEST = enum.auto()
    BAD_FRAME = enum.auto()
    NO_START = enum.auto()
    INVALID_START = enum.auto()
    INVALID_GOAL = enum.auto()
    UNREACHABLE = enum.auto()
    TIMEOUT = enum.auto()
    ITERATION_LIMIT = enum.auto()
    INEVITABLE_COLLISION = enum.auto()
    CANCELLED = enum.auto()
    INTERNAL_ERROR = enum.auto()

    @property
    def is_success(self) -> bool:
        """Return whether the caller got a path or draws."""
        return self in (Outcome.SOLVED, Outcome.SAMPLED)


class Refusal(HnrError):
    """A request ends without a result: the name of the outcome, and why in words."""

    def __init__(self, outcome: Outcome, why: str) -> None:
        super().__init__(why)
        self.outcome = outcome
        self.why = why
