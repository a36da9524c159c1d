"""
Calls of kernels by both tiers: ``python -m test.core.kernels.replays``.

A workload calls the package's functions. Around each kernel that Python code names, a ``Replay``
runs every call twice: by machine code, and interpreted, each on arguments of its own. What they
return must agree in value and in type, and so must what they wrote into their arguments. The
names of the workloads are printed, each once all kernels agreed that it called.

Some kernels return arrays of which they have written a part. So allocated memory must be zero
here: ``ZEROED`` is the environment in which the C library sees to that.
"""

from collections.abc import Callable, Iterator
import importlib
import math
import pkgutil
from test.laws import maps
from test.laws.spaces import SPACES
from types import ModuleType
from typing import Any

from hnr_planner import core
from hnr_planner.core import GridSpace, plan, Roadmap, sample, WALKS
from hnr_planner.core.kernels.kernel import interpreted, Kernel
from hnr_planner.core.planning.registry import ALGORITHMS
from hnr_planner.core.planning.roadmap.sampled import SampledRoadmap
from hnr_planner.core.systems import Car, DoubleIntegrator
from hnr_planner.core.trajectories.plan_trajectory import plan_trajectory
from hnr_planner.core.trajectories.registry import KINODYNAMIC_PLANNERS
from hnr_planner.core.warming import draw_samples, find_motions, find_paths, find_poses
import numpy as np
import pytest

#: Environment in which ``malloc`` fills what it returns with the complement of 255.
ZEROED = {'MALLOC_PERTURB_': '255', 'GLIBC_TUNABLES': 'glibc.malloc.tcache_count=0'}


class Replay:
    """A kernel whose every call is repeated interpreted, and compared."""

    def __init__(self, original: Any) -> None:
        self.original = original
        #: Names of the kernels that were called: a dispatched function has several.
        self.called: set[str] = set()

    def __getattr__(self, name: str) -> Any:
        """Be the kernel in all else."""
        return getattr(self.original, name)

    def __call__(self, *arguments: Any) -> Any:
        """Run both tiers; return what machine code returned."""
        own = copied(arguments)
        result = self.original(*arguments)
        with pytest.MonkeyPatch.context() as monkeypatch:
            monkeypatch.setattr(np, 'empty', np.zeros)
            monkeypatch.setattr(np, 'empty_like', np.zeros_like)
            plain = interpreted(self.original)(*own)
        assert not difference(result, plain), (self.original, difference(result, plain))
        assert not difference(arguments, own), (self.original, difference(arguments, own))
        own_kernel = self.original
        if not isinstance(own_kernel, Kernel):
            own_kernel = own_kernel.kernel_for(arguments[0])
        self.called.add(f'{own_kernel.__module__} {own_kernel.__qualname__}')
        return result


def copied(value: Any) -> Any:
    """Return a copy of arrays, and of tuples of them."""
    if isinstance(value, np.ndarray):
        return value.copy()
    if isinstance(value, tuple):
        members = map(copied, value)
        return value._make(members) if hasattr(value, '_make') else tuple(members)
    return value


def difference(a: Any, b: Any) -> str:
    """Return where two values differ in type or bits, where nan is nan; nothing if they do not."""
    if type(a) is not type(b):
        return f'{a!r} is not {b!r}'
    if isinstance(a, np.ndarray):
        is_float = a.dtype.kind == 'f'
        if a.dtype == b.dtype and np.array_equal(a, b, equal_nan=is_float):
            return ''
        where = np.argwhere(a != b)[:3].tolist() if a.shape == b.shape else ''
        return f'{a.dtype} {a.shape} is not {b.dtype} {b.shape}, at {where}: {a} {b}'
    if isinstance(a, tuple | list):
        names = getattr(a, '_fields', range(len(a)))
        each = (
            f'{name}: {found}'
            for name, one, other in zip(names, a, b, strict=True)
            if (found := difference(one, other))
        )
        return next(each, '')
    is_same = (a != a and b != b) or a == b
    if is_same and isinstance(a, float):
        is_same = a != a or math.copysign(1.0, a) == math.copysign(1.0, b)
    return '' if is_same else f'{a!r} is not {b!r}'


def same(a: Any, b: Any) -> bool:
    """Return whether two values have the same types and bits, where nan is nan."""
    return not difference(a, b)


def modules() -> Iterator[ModuleType]:
    """Import and yield every module of the core."""
    for found in pkgutil.walk_packages(core.__path__, f'{core.__name__}.'):
        yield importlib.import_module(found.name)


def is_kernel(value: Any) -> bool:
    return isinstance(value, Kernel) or (callable(value) and hasattr(value, 'interpreted_form'))


def replay(workload: Callable[[], None]) -> set[str]:
    """Run a workload with every call replayed; return the names of the kernels it called."""
    workload()  # so that all is compiled: numba does not know a ``Replay``
    with pytest.MonkeyPatch.context() as monkeypatch:
        replays = put_replays(monkeypatch)
        workload()
    return set().union(*(each.called for each in replays))


def put_replays(monkeypatch: pytest.MonkeyPatch) -> list[Replay]:
    """Put a ``Replay`` in the place of every kernel in every module of the core."""
    made: dict[int, Replay] = {}
    for module in list(modules()):
        for name, value in list(vars(module).items()):
            if is_kernel(value):
                monkeypatch.setattr(module, name, made.setdefault(id(value), Replay(value)))
    return list(made.values())


HALL = GridSpace.from_blocked(maps.rooms(24, 24, 8, seed=1), 0.05, (1.0, 2.0, 0.3))
LOWER, UPPER = HALL.bounds
START, GOAL = (1.06, 2.08), (1.45, 3.15)


def plan_paths() -> None:
    for algorithm in ALGORITHMS:
        for seed in range(2):
            _plan(HALL, START, GOAL, algorithm=algorithm, seed=seed, optimize_iterations=1)
    _plan(HALL, START, GOAL, seed=0, goal_radius=0.2)
    _plan(HALL, START, GOAL, seed=0, alternatives=3, clearance=0.05)
    HALL.nearest_reachable(START, (1.4, 2.4), 1.0)
    HALL.clearance(START)


def plan_by_roadmap() -> None:
    changed = maps.rooms(24, 24, 8, seed=1)
    changed[3:5, 3:5] = True
    space = GridSpace.from_blocked(changed, 0.05, (1.0, 2.0, 0.3))
    for roadmap in (
        Roadmap.build(HALL, seed=1),
        Roadmap.build(HALL, seed=1).update(space),
        Roadmap(1, SampledRoadmap.build(HALL, 1, None)),
    ):
        _plan(roadmap.space, START, GOAL, algorithm=roadmap, seed=0)


def plan_motions() -> None:
    for algorithm in KINODYNAMIC_PLANNERS:
        for system in (DoubleIntegrator(max_speed=0.5, max_acceleration=0.5), Car()):
            if algorithm == 'kinodynamic_connect' and isinstance(system, Car):
                continue  # which does not know it
            state = (*START, *([0.0] * (system.state_dim - 2)))
            plan_trajectory(
                HALL,
                system,
                state,
                GOAL,
                algorithm=algorithm,
                goal_radius=0.3,
                seed=0,
                time_limit=math.inf,
                max_iterations=60,
            )


def _plan(space: Any, start: Any, goal: Any, **options: Any) -> None:
    plan(space, start, goal, time_limit=math.inf, max_iterations=60, **options)


#: Spaces to walk in: each costs the compilation of a walk. In the others rays are cast.
WALKED = ('grid turned', 'polytope', 'sheared ball')


def sample_everywhere() -> None:
    for name, build in SPACES.items():
        space: Any = build()
        point = _free_point(space)
        for walk in WALKS if name == 'grid turned' else ('hit_and_run',):
            if name in WALKED:
                sample(space, point, 5, walk=walk, seed=0)
        for direction in np.random.default_rng(0).normal(size=(3, space.dim)):
            chord = space.chord(point, direction)
            space.is_motion_valid(point, point + 0.5 * chord.upper * direction)
        space.contains(np.array([point, point]))


def _free_point(space: Any) -> np.ndarray:
    rng, (lower, upper) = np.random.default_rng(0), space.bounds
    return next(x for x in rng.uniform(lower, upper, (100_000, space.dim)) if space.contains(x))


WORKLOADS: dict[str, Callable[[], None]] = {
    work.__name__: work
    for work in (
        find_paths,
        find_motions,
        find_poses,
        draw_samples,
        plan_paths,
        plan_by_roadmap,
        plan_motions,
        sample_everywhere,
    )
}


if __name__ == '__main__':
    for name, workload in WORKLOADS.items():
        assert replay(workload), f'{name} called no kernel'
        print(name, flush=True)
