"""The errors that this package raises on purpose."""


class HnrError(Exception):
    """
    The base class of every error that the package raises on purpose.

    Errors in arguments are also a ``ValueError``, and a stuck chain is also a ``RuntimeError``.
    """


class SpaceError(HnrError, ValueError):
    """The arguments for building a space describe no space: the message names value and rule."""


class RequestError(HnrError, ValueError):
    """An argument of a request is malformed: the message names the value and the rule."""


class Cancelled(HnrError):
    """A call was cancelled before it had a result to return."""


class Interrupted(HnrError):
    """An interpreted kernel ended early: its time limit had passed, or the call was cancelled."""


class StuckError(HnrError, RuntimeError):
    """A chain of a random walk has not moved for many steps in a row (1000)."""
