"""List the competitors that can run on this machine, and why others cannot."""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.competitors.competitor import Competitor, Missing
from benchmarks.competitors.grid import grid_searches, nano_a_star
from benchmarks.competitors.ompl_planners import ompl_native, ompl_wheel
from benchmarks.competitors.ours import ours

TEAMS: tuple[Callable[[], list[Competitor]], ...] = (
    ours,
    ompl_native,
    ompl_wheel,
    grid_searches,
    nano_a_star,
)


def lineup() -> tuple[list[Competitor], list[str]]:
    """Return the competitors, and a sentence for each group that is missing."""
    taking_part, missing = [], []
    for team in TEAMS:
        try:
            taking_part += team()
        except Missing as reason:
            missing.append(str(reason))
    return taking_part, missing
