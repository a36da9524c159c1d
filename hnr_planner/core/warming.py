"""
Compilation of the kernels to machine code ahead of the first request.

A use of the package (``USES``) is a workload: a function that makes typical requests on a small
grid, and so calls every kernel of that use. ``warm_up`` runs it and waits for the machine code
that is missing; ``compile_in_background`` returns at once, before the code is compiled;
``compile_all`` compiles into the cache on disk, for installers and container images, and reports
its progress.
"""

from collections.abc import Callable
import math
from typing import TypeAlias

from hnr_planner.core.checks import check_choice
from hnr_planner.core.kernels.compilation import prepare
from hnr_planner.core.kernels.modes import Mode, mode_of_thread
from hnr_planner.core.kernels.needs import Workload
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.kernels.workloads import needs_of
from hnr_planner.core.planning.batch.order import improve_ring
from hnr_planner.core.planning.batch.tour import tour
from hnr_planner.core.planning.limits import Budget
from hnr_planner.core.planning.plan import plan
from hnr_planner.core.planning.planner import make_problem
from hnr_planner.core.planning.planners.flood_fill import FloodFill
from hnr_planner.core.planning.poses.guide import detour_guide, guide_in_batches
from hnr_planner.core.planning.poses.search import POSE_PLANNERS
from hnr_planner.core.planning.registry import ALGORITHMS
from hnr_planner.core.sampling.sample import sample
from hnr_planner.core.sampling.walks import WALKS
from hnr_planner.core.spaces.grid.grid_space import GridSpace
from hnr_planner.core.spaces.poses.pose_space import PoseSpace
from hnr_planner.core.systems import DoubleIntegrator
from hnr_planner.core.trajectories.plan_trajectory import plan_trajectory
from hnr_planner.core.trajectories.problem import Motion
from hnr_planner.core.trajectories.reduce import reduce
from hnr_planner.core.trajectories.registry import KINODYNAMIC_PLANNERS
from hnr_planner.core.trajectories.request import check_kinodynamic_request
import numpy as np

#: Points on both sides of the wall of the small grid, so that there is something to search for.
START, GOAL = (0.5, 0.5), (0.5, 4.5)
#: Points in opposite corners of the grid with an island and of the winding one.
CORNER, OTHER_CORNER = (0.5, 0.5), (2.5, 2.5)
#: A robot that turns on the spot between the walls of the grid with an island.
FOOTPRINT = ((0.2, 0.15), (-0.2, 0.15), (-0.2, -0.15), (0.2, -0.15))
#: A twist.
AHEAD = (0.1, 0.0, 0.0)
#: Transitions of each search: enough to need all that a search needs.
N_ITERATIONS = 300

#: Called with the number of kernels done, their total number, and the name of the last one.
Progress: TypeAlias = Callable[[int, int, str], None]


def warm_up(*uses: str) -> None:
    """
    Compile, or load from the cache, all machine code for requests on a grid, and wait for it.

    Parameters
    ----------
    *uses : str
        Kinds of requests: 'paths', 'motions' of dynamic systems, 'samples', and 'poses' of robots
        with a footprint; all but 'poses' when none is named, as few robots need these.

    Raises
    ------
    RequestError
        When a use is none of these.

    """
    with mode_of_thread(Mode.COMPILED):
        for workload in _workloads(uses):
            workload.run()


def compile_in_background(*uses: str) -> None:
    """
    Load the machine code for requests on a grid, compile what is missing; return at once.

    Requests can run meanwhile. Where a kernel is not compiled yet, they run it interpreted, and it
    is compiled before the kernels that no request has called.
    ``hnr_planner.core.kernels.compilation.status`` returns the progress.

    Parameters
    ----------
    *uses : str
        As for ``warm_up``.

    Raises
    ------
    RequestError
        When a use is none of these.

    """
    for workload in _workloads(uses):
        prepare(workload)


def compile_all(*uses: str, progress: Progress | None = None) -> int:
    """
    Compile into the cache all machine code for requests on a grid, for installers and images.

    Parameters
    ----------
    *uses : str
        Kinds of requests, as for ``warm_up``; all when none is named.
    progress : callable, optional
        Called after each kernel with the number done, their total number, and its name.

    Returns
    -------
    int
        Number of kernels compiled: those that were not in the cache.

    Raises
    ------
    RequestError
        When a use is none of these.

    """
    needs = list(
        dict.fromkeys(need for use in _workloads(uses or tuple(USES)) for need in needs_of(use))
    )
    compiled = 0
    for done, need in enumerate(needs, start=1):
        kernel, signature = need.resolve()
        compiled += kernel.ensure_compiled(signature)
        if progress is not None:
            progress(done, len(needs), need.name)
    return compiled


def find_paths() -> None:
    """Plan by every algorithm, with every option that calls further kernels."""
    space, winding = _grid_with_island(), _winding_grid()
    for algorithm in ALGORITHMS:
        for grid in (space, winding):
            plan(
                grid,
                CORNER,
                OTHER_CORNER,
                algorithm=algorithm,
                seed=0,
                optimize_iterations=1,
                time_limit=math.inf,
                max_iterations=N_ITERATIONS,
            )
    plan(space, CORNER, OTHER_CORNER, seed=0, alternatives=2, clearance=1.0, time_limit=math.inf)
    tour(space, (CORNER, OTHER_CORNER), n_jobs=1)
    improve_ring(np.zeros((3, 3)), np.arange(3), 1, stream(0))  # for tours of more stops
    _fill(space)
    space.nearest_reachable(CORNER, OTHER_CORNER, 1.0)
    space.clearance(CORNER)
    space.path_clearance([CORNER, OTHER_CORNER])


def _fill(space: GridSpace) -> None:
    """Find a path by a flood fill, which ``auto`` begins after many steps only."""
    fill = FloodFill(make_problem(space, np.array(CORNER), np.array(OTHER_CORNER), 0.0))
    fill.advance(space.data.labels.size)
    _ = fill.path


def find_motions() -> None:
    """Plan for a system by every algorithm, for fast starts and long motions too."""
    space, system, start = _small_grid(), DoubleIntegrator(), (*START, 0.0, 0.0)
    for algorithm in KINODYNAMIC_PLANNERS:
        plan_trajectory(
            space,
            system,
            start,
            GOAL,
            algorithm=algorithm,
            goal_radius=1.0,
            seed=0,
            time_limit=math.inf,
            max_iterations=N_ITERATIONS,
        )
    wall = np.zeros((3, 3), dtype=bool)
    wall[0, 2] = True
    towards_wall = (*START, 1.9, 0.0)
    plan_trajectory(
        GridSpace.from_blocked(wall),
        DoubleIntegrator(max_speed=2.0),
        towards_wall,
        GOAL,
        seed=0,
        time_limit=math.inf,
        max_iterations=N_ITERATIONS,
    )
    _reduce_motion(space, system, start)


def _reduce_motion(space: GridSpace, system: DoubleIntegrator, start: tuple[float, ...]) -> None:
    """Reduce a motion of one step at rest, to call a kernel that else only long motions call."""
    request = check_kinodynamic_request(
        space,
        system,
        start,
        GOAL,
        algorithm='auto',
        settings={},
        goal_radius=1.0,
        goal_speed=math.inf,
        boundary='forbidden',
        simplify=None,
        seed=0,
    )
    at_rest = np.stack([request.problem.start] * 2)
    motion = Motion(np.ones(1), at_rest, np.zeros((1, system.control_dim)))
    reduce(request.problem, motion, request.geometric.stream(0), Budget(math.inf))


def find_poses() -> None:
    """Plan for a footprint by every algorithm, as a car and turning on the spot."""
    grid = _grid_with_island()
    for algorithm in POSE_PLANNERS:
        for drive, radius in (('car', 0.3), ('differential', 0.0)):
            space = PoseSpace(grid, FOOTPRINT, drive=drive, min_turning_radius=radius)
            result = plan(
                space,
                (*CORNER, 0.0),
                (*OTHER_CORNER, 1.0),
                algorithm=algorithm,
                seed=0,
                time_limit=math.inf,
                max_iterations=N_ITERATIONS,
            )
    # Long guides, and those of detours, are searched by kernels of their own.
    disc, (begin, end) = space.disc, space.to_kernel(result.path[[0, -1]])
    ends = make_problem(disc.space, disc.place(result.path[0]), disc.place(result.path[-1]), 0.0)
    guide_in_batches(disc, ends, Budget(math.inf))
    detour_guide(disc, begin, end, begin[:2], space.data.stride, Budget(math.inf), 0)
    space.clearance(result.path)
    space.is_motion_valid(result.path[0], AHEAD)
    space.chord(result.path[0], AHEAD)


def draw_samples() -> None:
    """Draw one sample by every walk, and compute one chord."""
    space = _small_grid()
    for walk in WALKS:
        sample(space, START, 1, walk=walk, seed=0)
    space.chord(START, (1.0, 0.0))


def _small_grid() -> GridSpace:
    """Return a grid with a wall across most of it."""
    blocked = np.zeros((5, 5), dtype=bool)
    blocked[2, :4] = True
    return GridSpace.from_blocked(blocked)


def _grid_with_island() -> GridSpace:
    """Return a grid with an obstacle between start and goal: paths have to be shortened."""
    blocked = np.zeros((12, 12), dtype=bool)
    blocked[4:8, 4:8] = True
    return GridSpace.from_blocked(blocked, 0.25)


def _winding_grid() -> GridSpace:
    """Return a winding corridor, in which searches need more than a first batch of steps."""
    blocked = np.zeros((15, 15), dtype=bool)
    blocked[1::2] = True
    blocked[1::4, -1] = blocked[3::4, 0] = False
    return GridSpace.from_blocked(blocked, 0.2)


#: The workload of each use.
USES = {
    'paths': Workload(__name__, 'find_paths'),
    'motions': Workload(__name__, 'find_motions'),
    'samples': Workload(__name__, 'draw_samples'),
    'poses': Workload(__name__, 'find_poses'),
}
#: The uses that are meant where none is named.
USUAL_USES = ('paths', 'motions', 'samples')


def _workloads(uses: tuple[str, ...]) -> list[Workload]:
    """
    Return the workloads of the named uses, or of the usual ones if ``uses`` is empty.

    Raise RequestError for a name that is not in ``USES``.
    """
    return [USES[check_choice('use', use, tuple(USES))] for use in uses or USUAL_USES]
