"""
Digests of what planners and walks return: equal where the results are, to the last bit.

``python -m test.digests`` computes every result with interpreted kernels and as machine code,
names those that differ, and writes the digests to a file. With ``--before FILE``, written by
another version, it also names those that differ from it: a change that should leave all results
as they are is held to that by one command.
"""

import argparse
from collections.abc import Callable, Iterator
import dataclasses
from enum import Enum
from functools import cache, partial
import hashlib
import json
import math
import os
from pathlib import Path
import subprocess
import sys
from test.core.planning.poses.test_words import DRIVES
from test.core.spaces.poses.robots import RECTANGLE
from test.core.trajectories.worlds import CAR, GOAL, INTEGRATOR, SPACE, START
from test.laws.spaces import SPACES
from typing import Any

from hnr_planner.core import (
    ALGORITHMS,
    CoordinateHitAndRunWalk,
    Gaussian,
    GridSpace,
    HitAndRunWalk,
    HnrError,
    KINODYNAMIC_ALGORITHMS,
    plan,
    plan_trajectory,
    PoseSpace,
    sample,
    simplify,
    WALKS,
)
from hnr_planner.core.kernels import modes
from hnr_planner.maps.building import building
from hnr_planner.maps.loading import load_map
import numpy as np
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[1]
MAPS = Path(os.environ.get('HNR_MAPS', '/nonexistent'))
#: Fields of a result that depend on the clock; a message may state a time.
TIMES = ('elapsed', 'message')
#: Options of ``plan`` that are tried with ``auto``.
OPTIONS: dict[str, dict[str, Any]] = {
    'as found': {'simplify': False},
    'clearance': {'clearance': 0.2},
    'alternatives': {'alternatives': 3},
    'goal region': {'goal_radius': 0.5},
}
#: A result of a name: a function of the seed.
Result = Callable[[int], object]


def digest(value: object) -> str:
    """Return 16 hex digits of arrays, numbers and texts, also in tuples and dataclasses."""
    digested = hashlib.sha256()
    for part in _parts(value):
        digested.update(part)
    return digested.hexdigest()[:16]


def _parts(value: object) -> Iterator[bytes]:
    """Yield the bytes of all leaves of a value, each after its type and size."""
    if dataclasses.is_dataclass(value) or hasattr(value, '_fields'):
        yield type(value).__name__.encode()
        for name in getattr(value, '_fields', None) or value.__dataclass_fields__:
            if name not in TIMES:
                yield from _parts(getattr(value, name))
    elif isinstance(value, tuple | list):
        yield f'{len(value)} items'.encode()
        for item in value:
            yield from _parts(item)
    elif isinstance(value, dict):
        yield from _parts(sorted(value.items()))
    elif isinstance(value, np.ndarray | np.generic | float | int):
        array = np.asarray(value)
        yield f'{array.dtype}{array.shape}'.encode()
        yield array.tobytes()
    elif isinstance(value, str | Enum | None):
        yield str(value).encode()
    else:
        raise TypeError(f'there is no digest of {value!r}')


def results() -> dict[str, Result]:
    """Return all results by name."""
    found: dict[str, Result] = {}
    for name, make in grids().items():
        for algorithm in ALGORITHMS:
            found[f'plan {algorithm}: {name}'] = partial(planned, make, algorithm=algorithm)
        for option, given in OPTIONS.items():
            found[f'plan auto, {option}: {name}'] = partial(planned, make, **given)
    for drive in DRIVES:
        found[f'plan poses: {drive}'] = partial(pose_path, drive)
    for algorithm in KINODYNAMIC_ALGORITHMS:
        for system in (INTEGRATOR, CAR):
            name = f'trajectory {algorithm}: {type(system).__name__}'
            found[name] = partial(trajectory, algorithm, system)
    for name in SPACES:
        for walk in (*WALKS, 'overrelaxed', 'gaussian'):
            found[f'sample {walk}: {name}'] = partial(drawn, name, walk)
    return found


def grids() -> dict[str, Callable[[], GridSpace]]:
    """Return maps by name: an office floor, and those of HNR_MAPS."""
    occupancy = {'office': building(5, resolution=0.1)}
    occupancy |= {file.stem: load_map(file) for file in sorted(MAPS.glob('depot.yaml'))}

    def grid(name: str) -> GridSpace:
        found = occupancy[name]
        return GridSpace.from_occupancy(
            found.data, found.resolution, found.origin, robot_radius=0.15
        )

    return {name: cache(partial(grid, name)) for name in occupancy}


def planned(make: Callable[[], GridSpace], seed: int, **options: Any) -> object:
    """Return the result of a request between two random free points, and its path shortened."""
    space = make()
    start, goal = free_points(space, 2, seed)
    bounded = {'time_limit': math.inf, 'max_iterations': 3000}
    result = plan(space, start, goal, seed=seed, **{**bounded, **options})
    if len(result.path) == 0:
        return result
    return result, simplify(space, result.path, seed=seed, max_iterations=50)


def pose_path(drive: str, seed: int) -> object:
    """Return the result of a request among the poses of a rectangle in two rooms."""
    blocked = np.zeros((30, 40), dtype=bool)
    blocked[:17, 20] = True
    space = PoseSpace(GridSpace.from_blocked(blocked, 0.2), RECTANGLE, **DRIVES[drive])
    bounded = {'time_limit': math.inf, 'max_iterations': 300}
    return plan(space, (1.5, 1.2, 0.0), (6.5, 2.2, 2.0), seed=seed, **bounded)


def trajectory(algorithm: str, system: Any, seed: int) -> object:
    """Return the result of a request for a trajectory through a serpentine."""
    start = START if system is INTEGRATOR else np.array([*START[:2], 0.4, 0.0])
    given = {'goal_radius': 0.5, 'time_limit': math.inf, 'max_iterations': 300}
    return plan_trajectory(SPACE, system, start, GOAL, algorithm=algorithm, seed=seed, **given)


def drawn(name: str, walk: str, seed: int) -> object:
    """Return the draws of a chain in a space of the laws."""
    space: Any = SPACES[name]()
    walks = {
        'overrelaxed': CoordinateHitAndRunWalk(overrelaxed=True),
        'gaussian': HitAndRunWalk(Gaussian(np.zeros(space.dim), 25.0 * np.ones(space.dim))),
    }
    (start,) = free_points(space, 1, seed)
    return sample(space, start, 100, walk=walks.get(walk, walk), thin=3, seed=seed)


def free_points(space: Any, k: int, seed: int) -> NDArray[np.float64]:
    """Return random free points (k, dim) of a space."""
    lower, upper = space.bounds
    points = np.random.default_rng(seed).uniform(lower, upper, (5000, space.dim))
    return points[space.contains(points)][:k]


def outcome(result: Result, seed: int) -> object:
    """Return a result, or what refused it, as a planner that the system does not have."""
    try:
        return result(seed)
    except HnrError as error:
        return f'{type(error).__name__}: {error}'


def compute(seeds: int, only: str = '') -> dict[str, list[str]]:
    """Return the digests for the seeds 0 to ``seeds - 1`` of all results, or of some, by name."""
    return {
        name: [digest(outcome(result, seed)) for seed in range(seeds)]
        for name, result in results().items()
        if only in name
    }


def differing(one: dict[str, list[str]], other: dict[str, list[str]]) -> list[str]:
    """Return the names of results of both that differ for a seed of both."""
    return [
        name
        for name in one.keys() & other.keys()
        if any(a != b for a, b in zip(one[name], other[name], strict=False))
    ]


def in_a_process(mode: modes.Mode, arguments: argparse.Namespace) -> subprocess.Popen[str]:
    """Start a process that prints the digests of all results in one mode."""
    command = [sys.executable, '-m', 'test.digests', '--mode', mode.value]
    command += ['--seeds', str(arguments.seeds), '--only', arguments.only]
    environment = os.environ | {modes.VARIABLE: mode.value}
    return subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True)


def _report(name: str, other: dict[str, list[str]], compiled: dict[str, list[str]]) -> int:
    """Print which results of machine code differ from others, and return their number."""
    found = sorted(differing(other, compiled))
    both = len(other.keys() & compiled.keys())
    print(f'{len(found)} of {both} differ from {name}', *found, sep='\n  ')
    return len(found)


def main() -> int:
    """Compute, compare and write the digests; return 1 if results differ."""
    parser = argparse.ArgumentParser(prog='python -m test.digests', description=__doc__)
    parser.add_argument('--seeds', type=int, default=5, help='seeds of each result; default 5')
    parser.add_argument('--only', default='', help='part of the names of the results to compute')
    parser.add_argument('--out', type=Path, default=Path('digests.json'), help='file to write')
    parser.add_argument('--before', type=Path, help='file of another version to compare with')
    parser.add_argument('--mode', help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.mode is not None:
        json.dump(compute(arguments.seeds, arguments.only), sys.stdout)
        return 0

    tiers = (modes.Mode.INTERPRETED, modes.Mode.COMPILED)
    interpreted, compiled = (
        json.loads(process.communicate()[0])
        for process in [in_a_process(mode, arguments) for mode in tiers]
    )
    arguments.out.write_text(json.dumps(compiled, indent=1) + '\n', encoding='utf-8')
    print(f'{len(compiled)} results of {arguments.seeds} seeds each, written to {arguments.out}')
    failed = _report('interpreted kernels', interpreted, compiled)
    if arguments.before is not None:
        before = json.loads(arguments.before.read_text(encoding='utf-8'))
        failed += _report(str(arguments.before), before, compiled)
    return 1 if failed else 0


if __name__ == '__main__':
    sys.exit(main())
