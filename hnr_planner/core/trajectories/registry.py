"""
The table of the planners of ``plan_trajectory``: name, class and description of each.

This module imports no planner, and neither NumPy nor numba, so that names and descriptions are
available at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from hnr_planner.core.planning.registry import PlannerEntry

_FOLDER = 'hnr_planner.core.trajectories'

#: The planners of ``plan_trajectory``, but for 'auto', which depends on the system.
KINODYNAMIC_ENTRIES = (
    PlannerEntry(
        'kinodynamic_connect',
        f'{_FOLDER}.connect',
        'KinodynamicConnect',
        'trees of Hit-and-Run steps find a path, which is driven and shortened in time',
    ),
    PlannerEntry(
        'kinodynamic_hit_and_run',
        f'{_FOLDER}.hit_and_run',
        'KinodynamicHitAndRun',
        "the paper's Hit-and-Run: one chain, driven to random positions and velocities",
    ),
    PlannerEntry(
        'kinodynamic_rrt',
        f'{_FOLDER}.rrt',
        'KinodynamicRRT',
        "the paper's RRT: a tree, driven from its nearest vertex to random states",
    ),
)
#: Description of 'auto', in one line.
AUTO_SUMMARY = (
    'kinodynamic_connect for a double integrator, a path of poses for a car on a grid, '
    'kinodynamic_rrt for other systems'
)

#: Names that ``plan_trajectory`` takes.
KINODYNAMIC_ALGORITHMS = ('auto', *(entry.name for entry in KINODYNAMIC_ENTRIES))


class _Classes(Mapping[str, type[Any]]):
    """A mapping from names to classes of planners; looking up a name imports its class."""

    def __init__(self, entries: tuple[PlannerEntry, ...]) -> None:
        self._entries = {entry.name: entry for entry in entries}

    def __getitem__(self, name: str) -> type[Any]:
        return self._entries[name].load()

    def __contains__(self, name: object) -> bool:
        return name in self._entries

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)


#: Planners for systems, by name.
KINODYNAMIC_PLANNERS: Mapping[str, type[Any]] = _Classes(KINODYNAMIC_ENTRIES)
