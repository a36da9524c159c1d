"""
The algorithms, free of ROS: spaces, walks on them, and planners.

The public names are loaded when they are first used, so that importing this package costs nothing;
``hnr_planner`` itself has the same ones.

>>> space = GridSpace.from_blocked(np.zeros((20, 20), bool), resolution=0.5)
>>> plan(space, start=(1, 1), goal=(9, 9), seed=0).status
<PlannerStatus.SOLVED: 'a path was found'>
"""

from importlib import import_module
from typing import Any

#: Every public name, by the module below this one that defines it. ``__init__.pyi`` has the same
#: names for type checkers and editors; a test compares the two.
_NAMES_OF_MODULES = {
    'errors': ('Cancelled', 'HnrError', 'RequestError', 'SpaceError', 'StuckError'),
    'planning.plan': ('plan',),
    'planning.planners.hit_and_run': ('HitAndRun',),
    'planning.planners.hit_and_run_connect': ('HitAndRunConnect',),
    'planning.planners.polyanya': ('Polyanya',),
    'planning.planners.rrt': ('RRT',),
    'planning.planners.rrt_connect': ('RRTConnect',),
    'planning.postprocessing.simplify': ('simplify',),
    'planning.registry': ('ALGORITHMS',),
    'planning.result': ('FirstSolution', 'PlanResult', 'PlannerStatus', 'SearchResult'),
    'planning.roadmap.roadmap': ('Roadmap',),
    'sampling.chains': ('Chains', 'begin_chains', 'walk_on'),
    'sampling.diagnostics': (
        'Diagnosis',
        'TotalVariation',
        'diagnose',
        'relaxation_time',
        'to_arviz',
        'total_variation',
    ),
    'sampling.free_space': ('FreeSpaceDraws', 'sample_free_space'),
    'sampling.sample': ('sample',),
    'sampling.walks': ('BallWalk', 'CoordinateHitAndRunWalk', 'HitAndRunWalk', 'WALKS'),
    'spaces': (
        'BallSpace',
        'BoxSpace',
        'Chord',
        'DifferenceSpace',
        'GridSpace',
        'OracleError',
        'OracleSpace',
        'PolygonSpace',
        'PolytopeSpace',
        'ProductSpace',
        'ShearedSpace',
        'Space',
        'UnionSpace',
    ),
    'systems': ('Car', 'DoubleIntegrator', 'System', 'Trajectory', 'join_trajectories'),
    'trajectories.plan_trajectory': ('plan_trajectory',),
    'trajectories.registry': ('KINODYNAMIC_ALGORITHMS', 'KINODYNAMIC_PLANNERS'),
    'trajectories.result': ('TrajectoryResult',),
    'warming': ('compile_all', 'compile_in_background', 'warm_up'),
}
_MODULE_OF = {name: module for module, names in _NAMES_OF_MODULES.items() for name in names}

__all__ = sorted(_MODULE_OF)


def __getattr__(name: str) -> Any:
    """Return a public name, loaded now and kept for the next time."""
    if name not in _MODULE_OF:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    value = getattr(import_module(f'{__name__}.{_MODULE_OF[name]}'), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the names of this module, those not loaded yet included."""
    return sorted({*globals(), *__all__})
