"""Output of the command ``plan``: the result as JSON, as text, and as a picture."""

from __future__ import annotations

import argparse
import json
import math
from typing import TYPE_CHECKING

from hnr_planner.cli.footprint import poses_of

if TYPE_CHECKING:
    from hnr_planner.core import GridSpace, PlanResult, PoseSpace
    from hnr_planner.maps import OccupancyMap
    from numpy.typing import NDArray


def as_json(result: PlanResult) -> str:
    """
    Return the result as one JSON object.

    The length is null where there is no path, and the lower bound where no path exists. For a
    robot with a footprint the path consists of poses, with the twists between them.
    """
    twists = {} if result.twists is None else {'twists': result.twists.tolist()}
    return json.dumps(
        {
            'status': result.status.name,
            'message': result.message,
            'algorithm': result.planner,
            'seed': result.seed,
            'iterations': result.iterations,
            'elapsed': result.elapsed,
            'length': _finite(result.length),
            'lower_bound': _finite(result.lower_bound),
            'clear_lower_bound': _finite(result.clear_lower_bound),
            'next_lower_bound': _finite(result.next_lower_bound),
            'path': result.path.tolist(),
            **twists,
            'paths': [path.tolist() for path in result.paths],
            'goal_offset': result.goal_offset,
            'escape': result.escape,
        }
    )


def _finite(number: float) -> float | None:
    """Return a number, or None where it is infinite, which JSON cannot express."""
    return number if math.isfinite(number) else None


def summary(space: GridSpace | PoseSpace, result: PlanResult) -> str:
    """Return the result as text: status, search, and length and points of every path."""
    lines = [
        f'{result.status.name}: {result.message}',
        f'search      {result.planner}, {result.iterations:,} transitions, '
        f'{len(result.samples):,} samples, {result.elapsed * 1e3:.1f} ms, seed {result.seed}',
    ]
    for path in result.paths:
        lines.append(f'path        {_measures(space, result, path)} m from the nearest obstacle')
        lines.append('            ' + ' '.join(_points(path.tolist())))
    return '\n'.join(lines)


def _measures(space: GridSpace | PoseSpace, result: PlanResult, path: NDArray) -> str:
    """Return the length of a path, its number of points or poses, and its clearance, in words."""
    from hnr_planner.core import PoseSpace

    if isinstance(space, PoseSpace):
        clearance = space.clearance(poses_of(space, result)).min()
        return f'{result.length:.2f} m, {len(path)} poses, {clearance:.2f}'
    length = sum(map(math.dist, path[:-1], path[1:]))
    return f'{length:.2f} m, {len(path)} points, {space.path_clearance(path):.2f}'


def _points(path: list[list[float]], most: int = 8) -> list[str]:
    """
    Return the points or poses of a path as text, one string each.

    Of a path of more than ``most`` points only the first and the last ``most`` / 2 are returned,
    with ``...`` between them.
    """
    words = ['(' + ', '.join(f'{number:.2f}' for number in point) + ')' for point in path]
    if len(words) <= most:
        return words
    half = most // 2
    return [*words[:half], '...', *words[-half:]]


def draw(
    arguments: argparse.Namespace,
    occupancy: OccupancyMap,
    space: GridSpace | PoseSpace,
    result: PlanResult,
) -> None:
    """Draw map, samples and paths into the file that ``--plot`` names."""
    from hnr_planner import drawing
    from hnr_planner.core import PoseSpace

    title = f'{result.planner}: {result.status.name}, {result.iterations:,} transitions'
    if len(result.path):
        title += f', {result.length:.1f} m'
    path, outlines = result.path, []
    if isinstance(space, PoseSpace):
        path, blocked = poses_of(space, result), space.grid.uninflated
        outlines = [space.outline(pose) for pose in path]
    else:
        blocked = space.blocked
    shown = drawing.Plan(
        title,
        path[:, :2],
        result.samples[:, :2],
        result.parents,
        tuple(arguments.start[:2]),
        tuple(arguments.goal[:2]),
        result.others,
        outlines,
    )
    figure = drawing.figure_of_plans(occupancy, [shown], blocked=blocked)
    drawing.save(figure, arguments.plot)
