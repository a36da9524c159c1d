"""The errors that this package raises on purpose."""


class HnrError(Exception):
    """Root of every error of the package; the particular ones are also built-in errors."""


class SpaceError(HnrError, ValueError):
    """A space was asked for with numbers that describe none."""


class RequestError(HnrError, ValueError):
    """An argument of a request is malformed: the message names the value and the rule."""


class Cancelled(HnrError):
    """Work that has no answer without its end was cancelled."""


class Interrupted(HnrError):
    """A kernel that ran interpreted ended early: its time is over, or it was cancelled."""


class StuckError(HnrError, RuntimeError):
    """A chain of a random walk does not move any more."""
