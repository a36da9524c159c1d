"""The command ``tour``: a short way through several stops on a map, in any order."""

from __future__ import annotations

import argparse
import json
import math
from typing import TYPE_CHECKING

from hnr_planner.cli.argument_types import number, picture
from hnr_planner.cli.arguments import (
    add_command,
    add_map_arguments,
    BadInputError,
    keep_map_files,
    open_map,
)
from hnr_planner.cli.extras import require_extra

if TYPE_CHECKING:
    from hnr_planner.core import GridSpace, Tour
    from hnr_planner.maps import OccupancyMap
    import numpy as np
    from numpy.typing import NDArray

#: Exit code when there is no way through all stops.
NO_TOUR = 1
EPILOG = """\
example:
  %(prog)s office.yaml --stops 3 22 34 5 12 8 20 20 --robot-radius 0.22 --closed

The first stop is where the tour begins. For up to 13 stops the order is the best of all; for more,
a search finds one that is hardly longer. Exit code 0: the order was found. 1: a stop cannot be
reached from the others. 2: the arguments or the map are not usable.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command ``tour`` to the command line."""
    parser = add_command(
        commands,
        'tour',
        run,
        summary='order stops on a map so that the way through them is short',
        description='Order stops on a map so that the way through all of them is short.',
        epilog=EPILOG,
    )
    add_map_arguments(parser)
    parser.add_argument(
        '--stops',
        type=number,
        nargs='+',
        required=True,
        metavar='X Y',
        help='the stops in the map frame [m], two numbers each; at most 200',
    )
    parser.add_argument(
        '--closed', action='store_true', help='return to the first stop in the end'
    )
    parser.add_argument('--json', action='store_true', help='print the result as a JSON object')
    parser.add_argument('--plot', type=picture, metavar='FILE.png', help='draw map, stops and way')


def run(arguments: argparse.Namespace) -> int:
    """Order the stops, print the result, and return the exit code: 0 for a way, 1 for none."""
    if len(arguments.stops) % 2 != 0:
        raise BadInputError(
            f'--stops takes two numbers for each stop, X and Y, got {len(arguments.stops)} numbers'
        )
    if arguments.plot:
        require_extra('plot', '--plot')
    from hnr_planner.core import tour
    import numpy as np

    occupancy, space = open_map(arguments)
    keep_map_files(arguments.map, arguments.plot)
    stops = np.reshape(arguments.stops, (-1, 2))
    found = tour(space, stops, closed=arguments.closed)
    path = _path(space, stops, found, closed=arguments.closed)
    print(_json(found, path) if arguments.json else _summary(stops, found))
    if arguments.plot:
        _draw(arguments, occupancy, space, stops[found.order], path)
        if not arguments.json:
            print(f'picture     {arguments.plot}')
    return 0 if math.isfinite(found.length) else NO_TOUR


def _path(space: GridSpace, stops: NDArray, found: Tour, *, closed: bool) -> NDArray[np.float64]:
    """Return the way (m, 2) through the stops (k, 2) [m]; (0, 2) where there is none."""
    from hnr_planner.core import plan_many
    import numpy as np

    if not math.isfinite(found.length):
        return np.empty((0, 2))
    order = [*found.order, *found.order[:closed]]
    legs = plan_many(space, stops[order[:-1]], stops[order[1:]])
    first = stops[found.order[:1]]
    return np.concatenate([first, *(legs.path(i)[1:] for i in range(len(legs)))])


def _json(found: Tour, path: NDArray) -> str:
    """Return the result as one JSON object; the length is null where there is no way."""
    return json.dumps(
        {
            'order': found.order.tolist(),
            'length': found.length if math.isfinite(found.length) else None,
            'path': path.tolist(),
        }
    )


def _summary(stops: NDArray, found: Tour) -> str:
    """Return the result as text: the length, and the stops in their order."""
    if not math.isfinite(found.length):
        return 'no way: a stop cannot be reached from the others'
    lines = [f'tour        {found.length:.2f} m through {len(stops)} stops']
    lines += [f'  stop {row}    ({stops[row, 0]:.2f}, {stops[row, 1]:.2f})' for row in found.order]
    return '\n'.join(lines)


def _draw(
    arguments: argparse.Namespace,
    occupancy: OccupancyMap,
    space: GridSpace,
    stops: NDArray,
    path: NDArray,
) -> None:
    """Draw map, stops (k, 2) [m] in their order, and way into the file that ``--plot`` names."""
    from hnr_planner import drawing
    import numpy as np

    parents = np.full(len(stops), -1)
    title = f'tour: {len(stops)} stops'
    ends = tuple(stops[0]), tuple(stops[0] if arguments.closed else stops[-1])
    shown = drawing.Plan(title, path, stops, parents, *ends)
    figure = drawing.figure_of_plans(occupancy, [shown], blocked=space.blocked)
    drawing.save(figure, arguments.plot)
