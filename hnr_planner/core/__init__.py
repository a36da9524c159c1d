"""
The algorithms, free of ROS: spaces, walks on them, and planners.

>>> space = GridSpace.from_blocked(np.zeros((20, 20), bool), resolution=0.5)
>>> plan(space, start=(1, 1), goal=(9, 9), seed=0).status
<PlannerStatus.SOLVED: 'a path was found'>
"""

from hnr_planner.core.errors import Cancelled, HnrError, RequestError, SpaceError, StuckError
from hnr_planner.core.planning.plan import plan
from hnr_planner.core.planning.planners.hit_and_run import HitAndRun
from hnr_planner.core.planning.planners.hit_and_run_connect import HitAndRunConnect
from hnr_planner.core.planning.planners.rrt import RRT
from hnr_planner.core.planning.planners.rrt_connect import RRTConnect
from hnr_planner.core.planning.postprocessing.simplify import simplify
from hnr_planner.core.planning.registry import ALGORITHMS
from hnr_planner.core.planning.result import FirstSolution, PlannerStatus, PlanResult
from hnr_planner.core.planning.roadmap.roadmap import Roadmap
from hnr_planner.core.sampling.chains import begin_chains, Chains, walk_on
from hnr_planner.core.sampling.diagnostics import (
    diagnose,
    Diagnosis,
    relaxation_time,
    to_arviz,
    total_variation,
    TotalVariation,
)
from hnr_planner.core.sampling.free_space import FreeSpaceDraws, sample_free_space
from hnr_planner.core.sampling.sample import sample
from hnr_planner.core.sampling.walks import (
    BallWalk,
    CoordinateHitAndRunWalk,
    HitAndRunWalk,
    WALKS,
)
from hnr_planner.core.spaces import (
    BallSpace,
    BoxSpace,
    Chord,
    DifferenceSpace,
    GridSpace,
    OracleError,
    OracleSpace,
    PolygonSpace,
    PolytopeSpace,
    ProductSpace,
    ShearedSpace,
    Space,
    UnionSpace,
)
from hnr_planner.core.trajectories.plan_trajectory import plan_trajectory
from hnr_planner.core.trajectories.registry import (
    KINODYNAMIC_ALGORITHMS,
    KINODYNAMIC_PLANNERS,
)
from hnr_planner.core.trajectories.result import TrajectoryResult
from hnr_planner.core.warm_up import warm_up

__all__ = [
    'ALGORITHMS',
    'KINODYNAMIC_ALGORITHMS',
    'KINODYNAMIC_PLANNERS',
    'RRT',
    'WALKS',
    'BallSpace',
    'BallWalk',
    'BoxSpace',
    'Cancelled',
    'Chains',
    'Chord',
    'CoordinateHitAndRunWalk',
    'Diagnosis',
    'DifferenceSpace',
    'FirstSolution',
    'FreeSpaceDraws',
    'GridSpace',
    'HitAndRun',
    'HitAndRunConnect',
    'HitAndRunWalk',
    'HnrError',
    'OracleError',
    'OracleSpace',
    'PlanResult',
    'PlannerStatus',
    'PolygonSpace',
    'PolytopeSpace',
    'ProductSpace',
    'RRTConnect',
    'RequestError',
    'Roadmap',
    'ShearedSpace',
    'Space',
    'SpaceError',
    'StuckError',
    'TotalVariation',
    'TrajectoryResult',
    'UnionSpace',
    'begin_chains',
    'diagnose',
    'plan',
    'plan_trajectory',
    'relaxation_time',
    'sample',
    'sample_free_space',
    'simplify',
    'to_arviz',
    'total_variation',
    'walk_on',
    'warm_up',
]
