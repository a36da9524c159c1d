"""The outcomes of requests, and the exception ``Refusal`` that ends one without a result."""

import enum

from hnr_planner.core.errors import HnrError


class Outcome(enum.Enum):
    """
    How a request ended.

    An outcome that the planner decides has the same name as the planner's status.
    """

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
        """Whether the caller got what was asked for: a path (SOLVED) or draws (SAMPLED)."""
        return self in (Outcome.SOLVED, Outcome.SAMPLED)


class Refusal(HnrError):
    """A request ends without a result: with ``outcome``, and the reason ``why`` in words."""

    def __init__(self, outcome: Outcome, why: str) -> None:
        super().__init__(why)
        self.outcome = outcome
        self.why = why
