"""Kinodynamic planners by name."""

from typing import Any

from hnr_planner.core.errors import RequestError
from hnr_planner.core.planning.registry import make_planner, PlannerEntry
from hnr_planner.core.systems.double_integrator import DoubleIntegrator
from hnr_planner.core.systems.system import System
from hnr_planner.core.trajectories.connect import KinodynamicConnect
from hnr_planner.core.trajectories.hit_and_run import KinodynamicHitAndRun
from hnr_planner.core.trajectories.problem import KinodynamicPlanner
from hnr_planner.core.trajectories.rrt import KinodynamicRRT

_KINDS = (KinodynamicConnect, KinodynamicHitAndRun, KinodynamicRRT)

#: Planners for systems, by name.
KINODYNAMIC_PLANNERS: dict[str, type[Any]] = {kind.name: kind for kind in _KINDS}

#: Names that ``plan`` takes beside a system.
KINODYNAMIC_ALGORITHMS = ('auto', *KINODYNAMIC_PLANNERS)


def make_kinodynamic_planner(
    algorithm: Any, settings: dict[str, Any], system: System
) -> KinodynamicPlanner:
    """
    Return the planner that ``algorithm`` means for a system, likewise built with ``settings``.

    Raises
    ------
    RequestError
        As ``make_planner``, or when the planner is none for this system.

    """
    connects = isinstance(system, DoubleIntegrator)
    best = KinodynamicConnect if connects else KinodynamicRRT
    entries = [
        PlannerEntry(name, kind.__module__, kind.__name__, '')
        for name, kind in {'auto': best, **KINODYNAMIC_PLANNERS}.items()
    ]
    planner: Any = make_planner(algorithm, settings, entries)
    if not hasattr(planner, 'boundary'):
        raise RequestError(f'{planner.name} plans without a system; one of {_names()} has to')
    if isinstance(planner, KinodynamicConnect) and not connects:
        raise RequestError(
            f'{planner.name} connects states of a DoubleIntegrator only, got a '
            f'{type(system).__name__}'
        )
    return planner


def _names() -> str:
    return ', '.join(KINODYNAMIC_ALGORITHMS)
