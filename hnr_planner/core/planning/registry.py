"""
The planners of ``plan``, each listed once.

Names and descriptions need no import of a planner, so that command lines and documentation can
show them at once: this module imports neither NumPy nor numba.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from functools import cache
from importlib import import_module
from typing import Any, NamedTuple

from hnr_planner.core.errors import RequestError

_PLANNERS = 'hnr_planner.core.planning.planners'


class PlannerEntry(NamedTuple):
    """
    A planner's name, the location of its class, and a description of how it searches.

    Attributes
    ----------
    name : str
        Name of the planner as a value of the argument ``algorithm``.
    module, class_name : str
        Module and name of the planner's class, which is imported when a planner is made.
    summary : str
        One line on how the planner searches.

    """

    name: str
    module: str
    class_name: str
    summary: str

    def load(self) -> type[Any]:
        """Import and return the planner's class, a dataclass whose fields are its settings."""
        return _load(self.module, self.class_name)


@cache
def _load(module: str, class_name: str) -> type[Any]:
    kind: type[Any] = getattr(import_module(module), class_name)
    return kind


#: The planners of ``plan``.
PLANNERS = (
    PlannerEntry(
        'auto',
        f'{_PLANNERS}.auto',
        'Auto',
        'for any request: hit_and_run_connect, and on a grid a flood fill where that takes long',
    ),
    PlannerEntry(
        'hit_and_run',
        f'{_PLANNERS}.hit_and_run',
        'HitAndRun',
        "the paper's Hit-and-Run: a chain of steps from the start to where the goal is visible",
    ),
    PlannerEntry(
        'rrt',
        f'{_PLANNERS}.rrt',
        'RRT',
        "the paper's RRT: a tree that grows towards uniform points of the space",
    ),
    PlannerEntry(
        'hit_and_run_connect',
        f'{_PLANNERS}.hit_and_run_connect',
        'HitAndRunConnect',
        'trees of Hit-and-Run steps from both ends, joined by the first free segment between them',
    ),
    PlannerEntry(
        'rrt_connect',
        f'{_PLANNERS}.rrt_connect',
        'RRTConnect',
        'RRT-Connect: RRTs from both ends, each extended towards the new vertices of the other',
    ),
    PlannerEntry(
        'polyanya',
        f'{_PLANNERS}.polyanya',
        'Polyanya',
        'on a grid only: the shortest path, exactly, by a search over cones of visible points',
    ),
)

#: Names that ``plan`` takes.
ALGORITHMS = tuple(entry.name for entry in PLANNERS)


def make_planner(
    algorithm: Any, settings: dict[str, Any], entries: Sequence[PlannerEntry] = PLANNERS
) -> Any:
    """
    Return the planner that ``algorithm`` names, built with ``settings``, or the planner given.

    Parameters
    ----------
    algorithm : str or planner
        A name of ``entries``, or a planner value, which is returned as it is.
    settings : dict
        Settings of the planner that ``algorithm`` names; empty with a planner value.
    entries : sequence of PlannerEntry
        The planners to choose from.

    Raises
    ------
    RequestError
        When the name or a setting is unknown, or settings are given with a planner value.

    """
    if not isinstance(algorithm, str):
        if isinstance(algorithm, type) or not callable(getattr(algorithm, 'start', None)):
            raise RequestError(f'algorithm must be a name or a planner value, got {algorithm!r}')
        if settings:
            raise RequestError(f'settings {sorted(settings)} go with the name of a planner only')
        return algorithm
    kind = _entry_named(algorithm, entries).load()
    if settings:
        _check_settings(kind, settings)
    return kind(**settings)


def _entry_named(name: str, entries: Sequence[PlannerEntry]) -> PlannerEntry:
    """Return the one of ``entries`` with a name, or raise RequestError where there is none."""
    for entry in entries:
        if entry.name == name:
            return entry
    names = ', '.join(entry.name for entry in entries)
    raise RequestError(f'algorithm must be one of {names}, got {name!r}')


def _check_settings(kind: type[Any], settings: dict[str, Any]) -> None:
    """Raise RequestError where a planner's class has no field of a setting's name."""
    known = [field.name for field in fields(kind)]
    for setting in settings:
        if setting not in known:
            has = ', '.join(known) or 'no settings'
            raise RequestError(f'{kind.name} has no setting {setting!r}; it has {has}')
