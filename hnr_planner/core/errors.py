"""The errors that this package raises on purpose."""


class HnrError(Exception):
    """Root of every error of the package; the particular ones are also built-in errors."""


class SpaceError(HnrError, ValueError):
    """The arguments of a space describe none: the message names the value and the rule."""


class RequestError(HnrError, ValueError):
    """An argument of a request is malformed: the message names the value and the rule."""


class Cancelled(HnrError):
    """A call was cancelled before it had a result to return."""


class Interrupted(HnrError):
    """An interpreted kernel ended early: its time was over, or the call was cancelled."""


class StuckError(HnrError, RuntimeError):
    """A chain of a random walk has stopped moving."""
