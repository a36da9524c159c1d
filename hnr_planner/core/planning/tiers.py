"""The tier of a request: whether machine code did all of it, and a remark in the result if not."""

from dataclasses import replace
from typing import TypeVar

from hnr_planner.core.kernels.compilation import status
from hnr_planner.core.kernels.kernel import interpreted_calls
from hnr_planner.core.kernels.modes import Mode, mode
from hnr_planner.core.planning.result import SearchResult

Result = TypeVar('Result', bound=SearchResult)


def tier_since(before: int) -> str:
    """
    Return 'compiled' if no kernel has run interpreted since ``before``, else 'interpreted'.

    ``before`` is the value of ``interpreted_calls()`` when the work began.
    """
    return 'compiled' if interpreted_calls() == before else 'interpreted'


def remark_since(before: int) -> str:
    """
    Return the remark for the message of work that a limit cut: why it ran interpreted.

    The remark is empty if no kernel has run interpreted since ``before``.

    Parameters
    ----------
    before : int
        Value of ``interpreted_calls()`` when the work began.

    """
    if tier_since(before) == 'compiled':
        return ''
    why = 'this process compiles nothing' if mode() is Mode.INTERPRETED else str(status())
    return f'; it ran interpreted: {why}'


def with_remark(result: Result, before: int) -> Result:
    """
    Return ``result``, with a remark in its message if a limit cut it and it ran interpreted.

    ``before`` is the value of ``interpreted_calls()`` when the work began.
    """
    if not result.cut_by_time:
        return result
    return replace(result, message=result.message + remark_since(before))
