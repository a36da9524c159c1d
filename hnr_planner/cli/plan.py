"""The command ``plan``: a path between two points of a map."""

from __future__ import annotations

import argparse
import json
import math
from typing import Any, TYPE_CHECKING

from hnr_planner.cli.arguments import (
    add_map_arguments,
    compile_kernels,
    count,
    keep_map_files,
    length,
    number,
    open_map,
    page,
    picture,
    positive,
    whole,
)

if TYPE_CHECKING:
    from hnr_planner.core import GridSpace, PlanResult
    from hnr_planner.maps import OccupancyMap

ALGORITHM_NAMES = (
    'auto',
    'hit_and_run',
    'rrt',
    'hit_and_run_connect',
    'rrt_connect',
)  # those of the core, here so that --help is fast
NO_PATH = 1
EPILOG = """\
example:
  python -m hnr_planner plan office.yaml --start 2 3 --goal 30 20 --robot-radius 0.22 \\
      --plot plan.png

Exit code 0: a path was found. 1: none, and the status says why: INVALID_START, INVALID_GOAL,
UNREACHABLE (proved) or TIMEOUT. 2: the arguments or the map are not usable.
The same seed gives the same path, unless a clock cut the search.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        'plan',
        help='find a path between two points of a map',
        description='Find a path between two points of a map, clear of obstacles for the robot.',
        epilog=EPILOG,
    )
    add_map_arguments(parser)
    for name in ('start', 'goal'):
        parser.add_argument(
            f'--{name}',
            type=number,
            nargs=2,
            metavar=('X', 'Y'),
            required=True,
            help=f'the {name} in the frame of the map [m]',
        )
    parser.add_argument(
        '--algorithm',
        choices=ALGORITHM_NAMES,
        default='auto',
        help='how to search; default auto, the best there is for a map',
    )
    parser.add_argument(
        '--goal-radius',
        type=length,
        default=0.0,
        metavar='R',
        help='a point this near to the goal will do [m]; default 0, exactly there',
    )
    parser.add_argument(
        '--time-limit',
        type=positive,
        default=1.0,
        metavar='S',
        help='the longest that all of it may take [s]; default 1',
    )
    parser.add_argument(
        '--optimize-for',
        type=length,
        default=0.0,
        metavar='S',
        help='look for a shorter path until so long [s] after the call, ending with the time '
        'limit; default 0',
    )
    parser.add_argument(
        '--clearance',
        type=length,
        default=0.0,
        metavar='R',
        help='keep this far from obstacles where there is room [m], and pass narrow places in '
        'their middle; default 0, the shortest path',
    )
    parser.add_argument(
        '--alternatives',
        type=count,
        default=1,
        metavar='K',
        help='look for up to this many paths that pass obstacles on different sides, the '
        'shortest first; default 1',
    )
    parser.add_argument(
        '--seed', type=whole, metavar='N', help='seed of the random numbers; default a fresh one'
    )
    parser.add_argument(
        '--no-simplify',
        dest='simplify',
        action='store_false',
        help='leave the path as the search found it, with all its detours',
    )
    parser.add_argument('--json', action='store_true', help='print the result as a JSON object')
    parser.add_argument(
        '--plot', type=picture, metavar='FILE.png', help='draw map, samples and path'
    )
    parser.add_argument(
        '--html',
        type=page,
        metavar='FILE.html',
        help='write a page that shows how this search unfolds, and that of every other algorithm '
        'for the same request',
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Plan, print the result, draw it if asked, and return the exit code."""
    from hnr_planner.core import plan, PlannerStatus

    occupancy, space = open_map(arguments)
    keep_map_files(arguments.map, arguments.plot, arguments.html)
    compile_kernels('paths')
    request = _request(arguments)
    result = plan(space, **request)
    print(_json(result) if arguments.json else _summary(space, result))
    if arguments.plot:
        _draw(arguments, occupancy, space, result)
        if not arguments.json:
            print(f'picture     {arguments.plot}')
    if arguments.html:
        from hnr_planner.cli.plan_page import write_plan_page

        write_plan_page(arguments, occupancy, space, request, result)
        if not arguments.json:
            print(f'page        {arguments.html}')
    return 0 if result.status is PlannerStatus.SOLVED else NO_PATH


def _request(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return what ``plan`` takes besides the space."""
    request = {
        'start': arguments.start,
        'goal': arguments.goal,
        'algorithm': arguments.algorithm,
        'goal_radius': arguments.goal_radius,
        'time_limit': arguments.time_limit,
        'seed': arguments.seed,
        'simplify': arguments.simplify,
        'optimize_for': arguments.optimize_for,
        'alternatives': arguments.alternatives,
    }
    return request | ({'clearance': arguments.clearance} if arguments.clearance else {})


def _json(result: PlanResult) -> str:
    """Return the result as one JSON object; without a path its length is null."""
    return json.dumps(
        {
            'status': result.status.name,
            'message': result.message,
            'algorithm': result.planner,
            'seed': result.seed,
            'iterations': result.iterations,
            'elapsed': result.elapsed,
            'length': result.length if math.isfinite(result.length) else None,
            'path': result.path.tolist(),
            'paths': [path.tolist() for path in result.paths],
        }
    )


def _summary(space: GridSpace, result: PlanResult) -> str:
    """Return the result for a person."""
    lines = [
        f'{result.status.name}: {result.message}',
        f'search      {result.planner}, {result.iterations:,} transitions, '
        f'{len(result.samples):,} samples, {result.elapsed * 1e3:.1f} ms, seed {result.seed}',
    ]
    for path in result.paths:
        length = sum(map(math.dist, path[:-1], path[1:]))
        lines.append(
            f'path        {length:.2f} m, {len(path)} points, '
            f'{space.path_clearance(path):.2f} m from the nearest obstacle'
        )
        lines.append('            ' + ' '.join(_points(path.tolist())))
    return '\n'.join(lines)


def _points(path: list[list[float]], most: int = 8) -> list[str]:
    """Return the points of a path in words, those in the middle left out when there are many."""
    words = [f'({x:.2f}, {y:.2f})' for x, y in path]
    if len(words) <= most:
        return words
    half = most // 2
    return [*words[:half], '...', *words[-half:]]


def _draw(
    arguments: argparse.Namespace, occupancy: OccupancyMap, space: GridSpace, result: PlanResult
) -> None:
    """Write the picture."""
    from hnr_planner import drawing

    title = f'{result.planner}: {result.status.name}, {result.iterations:,} transitions'
    if len(result.path):
        title += f', {result.length:.1f} m'
    shown = drawing.Plan(
        title,
        result.path,
        result.samples,
        result.parents,
        tuple(arguments.start),
        tuple(arguments.goal),
        result.others,
    )
    figure = drawing.figure_of_plans(occupancy, [shown], blocked=space.blocked)
    drawing.save(figure, arguments.plot)
