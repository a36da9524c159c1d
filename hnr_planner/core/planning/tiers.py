"""The tier of a request: whether machine code did all of it, and a remark in the result if not."""

from dataclasses import replace
from typing import TypeVar

from hnr_planner.core.kernels.compilation import status
from hnr_planner.core.kernels.kernel import interpreted_calls
from hnr_planner.core.kernels.modes import Mode, mode
from hnr_planner.core.planning.result import SearchResult

Result = TypeVar('Result', bound=SearchResult)


def tier_since(before: int) -> str:
    """Return 'compiled', or 'interpreted' where ``interpreted_calls()`` is not ``before`` now."""
    return 'compiled' if interpreted_calls() == before else 'interpreted'


def remark_since(before: int) -> str:
    """
    Return what a message adds about work that was cut: why it was slow, if it ran interpreted.

    Parameters
    ----------
    before : int
        What ``interpreted_calls()`` was when the work began.

    """
    if tier_since(before) == 'compiled':
        return ''
    why = 'this process compiles nothing' if mode() is Mode.INTERPRETED else str(status())
    return f'; it ran interpreted: {why}'


def with_remark(result: Result, before: int) -> Result:
    """Return a result whose message names the tier where a limit cut interpreted work."""
    if not result.cut_by_time:
        return result
    return replace(result, message=result.message + remark_since(before))
