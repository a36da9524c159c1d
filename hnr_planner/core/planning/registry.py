"""Planners by name."""

from dataclasses import fields
from typing import Any

from hnr_planner.core.checks import check_choice
from hnr_planner.core.errors import RequestError
from hnr_planner.core.planning.planner import Planner
from hnr_planner.core.planning.planners.hit_and_run import HitAndRun
from hnr_planner.core.planning.planners.hit_and_run_connect import HitAndRunConnect
from hnr_planner.core.planning.planners.rrt import RRT
from hnr_planner.core.planning.planners.rrt_connect import RRTConnect

_PLANNERS = (HitAndRun, RRT, HitAndRunConnect, RRTConnect)
_KINDS: dict[str, type[Any]] = {
    'auto': HitAndRunConnect,
    **{planner.name: planner for planner in _PLANNERS},
}

#: Names that ``plan`` takes.
ALGORITHMS = tuple(_KINDS)


def make_planner(
    algorithm: str | Planner, settings: dict[str, Any], kinds: dict[str, type[Any]] = _KINDS
) -> Planner:
    """
    Return the planner that ``algorithm`` means, built with ``settings`` where it is a name.

    The names are those of ``kinds``.

    Raises
    ------
    RequestError
        When the name or a setting is unknown, or settings come beside a planner value.

    """
    if not isinstance(algorithm, str):
        if isinstance(algorithm, type) or not callable(getattr(algorithm, 'start', None)):
            raise RequestError(f'algorithm must be a name or a planner value, got {algorithm!r}')
        if settings:
            raise RequestError(f'settings {sorted(settings)} go with the name of a planner only')
        return algorithm
    kind = kinds[check_choice('algorithm', algorithm, tuple(kinds))]
    known = [field.name for field in fields(kind)]
    for setting in settings:
        if setting not in known:
            has = ', '.join(known) or 'no settings'
            raise RequestError(f'{kind.name} has no setting {setting!r}; it has {has}')
    return kind(**settings)
