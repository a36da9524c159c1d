"""The command ``plan``: a path between two points of a map."""

from __future__ import annotations

import argparse
from typing import Any

from hnr_planner.cli.argument_types import count, length, page, picture, positive, whole
from hnr_planner.cli.arguments import (
    add_command,
    add_map_arguments,
    keep_map_files,
    listing,
    open_map,
)
from hnr_planner.cli.extras import require_extra
from hnr_planner.cli.footprint import (
    add_footprint_arguments,
    add_planning_arguments,
    planning_options,
    pose_space,
)
from hnr_planner.cli.plan_output import as_json, draw, summary
from hnr_planner.core.planning.registry import ALGORITHMS, PLANNERS

#: Default of ``--optimize-for`` [s].
OPTIMIZE_FOR = 0.02
#: Exit code when no path was found.
NO_PATH = 1
EPILOG = """\
example:
  %(prog)s office.yaml --start 2 3 --goal 30 20 --robot-radius 0.22 --plot plan.png
  %(prog)s office.yaml --start 2 3 0 --goal 30 20 1.57 --drive car --min-turning-radius 0.5 \\
      --footprint "[[0.55, 0.3], [-0.35, 0.3], [-0.35, -0.3], [0.55, -0.3]]" --html plan.html

algorithms (with --footprint all but polyanya):
{algorithms}

Exit code 0: a path was found. 1: no path was found; the status names the reason: INVALID_START,
INVALID_GOAL, UNREACHABLE (proved) or TIMEOUT. 2: the arguments or the map are not usable.
The same seed gives the same path, unless a time limit cut the search.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command ``plan`` to the command line."""
    parser = add_command(
        commands,
        'plan',
        run,
        summary='find a path between two points of a map',
        description='Find a path between two points of a map, clear of obstacles for the robot.',
        epilog=EPILOG.format(algorithms=listing(PLANNERS)),
    )
    add_map_arguments(parser)
    for name in ('start', 'goal'):
        text = f'the {name} in the map frame [m]; with --footprint X Y YAW [m, m, rad]'
        parser.add_point(f'--{name}', required=True, text=text)
    parser.add_argument(
        '--algorithm',
        choices=ALGORITHMS,
        default='auto',
        metavar='A',
        help='the planner, one of those below; default auto',
    )
    parser.add_argument(
        '--goal-radius',
        type=length,
        default=0.0,
        metavar='R',
        help='radius of the goal region [m]: a path may end anywhere in it; default 0, exactly at '
        'the goal',
    )
    parser.add_argument(
        '--time-limit',
        type=positive,
        default=1.0,
        metavar='S',
        help='time limit of planning [s]: search, simplification and --optimize-for together, '
        'but not reading the map, preparing the space, compiling, --plot and --html; default 1',
    )
    parser.add_argument(
        '--optimize-for',
        type=length,
        metavar='S',
        help='keep looking for a shorter path until this long after the start of planning [s], '
        f'within the time limit; 0 for the first path; default {OPTIMIZE_FOR:g}, with '
        '--no-simplify 0',
    )
    parser.add_argument(
        '--clearance',
        type=length,
        default=0.0,
        metavar='R',
        help='keep this distance from obstacles where the free space is wide enough [m], and pass '
        'narrow places in their middle; default 0, the shortest path',
    )
    parser.add_argument(
        '--alternatives',
        type=count,
        default=1,
        metavar='K',
        help='find up to this many paths that pass obstacles on different sides, the shortest '
        'first; default 1',
    )
    parser.add_argument(
        '--seed', type=whole, metavar='N', help='seed of the random numbers; default a fresh one'
    )
    parser.add_argument(
        '--no-simplify',
        dest='simplify',
        action='store_false',
        help='return the path as the search found it, with all its detours',
    )
    parser.add_argument(
        '--goal-tolerance',
        type=length,
        default=0.0,
        metavar='R',
        help='where the goal is blocked or unreachable, end at the nearest reachable point within '
        'this distance [m]; default 0',
    )
    parser.add_argument(
        '--start-escape',
        type=length,
        default=0.0,
        metavar='R',
        help='where the start lies within the radius of the robot from an obstacle, begin with a '
        'straight way out of at most this length [m]; default 0',
    )
    parser.add_argument('--json', action='store_true', help='print the result as a JSON object')
    parser.add_argument(
        '--plot', type=picture, metavar='FILE.png', help='draw map, samples and path'
    )
    parser.add_argument(
        '--html',
        type=page,
        metavar='FILE.html',
        help='write an HTML page that shows how this search unfolds, and how every other '
        'algorithm searches for the same request',
    )
    group = add_footprint_arguments(
        parser,
        'With --footprint a path is one of poses: --start and --goal take X Y YAW\n'
        '[m, m, rad], and the whole outline is free on all of the way.',
    )
    add_planning_arguments(group)


def run(arguments: argparse.Namespace) -> int:
    """
    Plan, print the result, and return the exit code: 0 for a path, 1 for none.

    The picture and the page are written where ``--plot`` and ``--html`` name files.
    """
    from hnr_planner.core import plan, PlannerStatus

    for option, file in (('--plot', arguments.plot), ('--html', arguments.html)):
        if file:
            require_extra('plot', option)
    occupancy, grid = open_map(arguments)
    space = pose_space(arguments, grid) or grid
    keep_map_files(arguments.map, arguments.plot, arguments.html)
    request = _request(arguments)
    result = plan(space, **request)
    print(as_json(result) if arguments.json else summary(space, result))
    if arguments.plot:
        draw(arguments, occupancy, space, result)
        if not arguments.json:
            print(f'picture     {arguments.plot}')
    if arguments.html:
        from hnr_planner.cli.plan_page import write_plan_page

        write_plan_page(arguments, occupancy, space, request, result)
        if not arguments.json:
            print(f'page        {arguments.html}')
    return 0 if result.status is PlannerStatus.SOLVED else NO_PATH


def _request(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments for the function ``plan``, by name, other than the space."""
    return {
        'start': arguments.start,
        'goal': arguments.goal,
        'algorithm': arguments.algorithm,
        'goal_radius': arguments.goal_radius,
        'time_limit': arguments.time_limit,
        'seed': arguments.seed,
        'simplify': arguments.simplify,
        'optimize_for': optimize_for(arguments),
        'alternatives': arguments.alternatives,
        'clearance': arguments.clearance,
        'goal_tolerance': arguments.goal_tolerance,
        'start_escape': arguments.start_escape,
        **planning_options(arguments),
    }


def optimize_for(arguments: argparse.Namespace) -> float:
    """
    Return until how long after the start of planning to look for a shorter path [s].

    It is ``--optimize-for`` where that is given, else 0 with ``--no-simplify``, else 0.02.
    """
    if arguments.optimize_for is not None:
        return float(arguments.optimize_for)
    return OPTIMIZE_FOR if arguments.simplify else 0.0
