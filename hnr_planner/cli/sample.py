"""The command ``sample``: uniform points of the free part of a map."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
import secrets
import sys
from typing import TextIO, TYPE_CHECKING

from hnr_planner.cli.arguments import (
    add_map_arguments,
    BadInputError,
    compile_kernels,
    count,
    keep_map_files,
    number,
    open_map,
    output_file,
    picture,
    whole,
)

if TYPE_CHECKING:
    from hnr_planner.core import GridSpace
    from numpy.typing import NDArray

WALK_NAMES = ('hit_and_run', 'coordinate_hit_and_run')  # those of the core; see plan.py
EPILOG = """\
example:
  python -m hnr_planner sample office.yaml --n 1000 --csv points.csv --plot points.png

The points are those of a random walk. Left to itself, the walk starts at a uniform point of the
largest connected free part of the map, so every one of its points is uniform there; neighbours
in the list depend on each other. With --start it walks on the part in which the start lies, and
the first points are still near the start. --thin K lets the walk take K steps for each point:
the points depend less on each other. The same seed gives the same points.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        'sample',
        help='draw uniform points of the free part of a map',
        description='Draw uniform points of the free part of a map, by a random walk.',
        epilog=EPILOG,
    )
    add_map_arguments(parser)
    parser.add_argument('--n', type=count, required=True, metavar='N', help='how many points')
    parser.add_argument(
        '--walk',
        choices=WALK_NAMES,
        default='hit_and_run',
        help='the random walk; default hit_and_run',
    )
    parser.add_argument(
        '--thin',
        type=count,
        default=1,
        metavar='K',
        help='keep every K-th point of the walk and drop those between; default 1, every point',
    )
    parser.add_argument(
        '--start',
        type=number,
        nargs=2,
        metavar=('X', 'Y'),
        help='where the walk starts [m]; default anywhere in the largest free part',
    )
    parser.add_argument(
        '--seed', type=whole, metavar='N', help='seed of the random numbers; default a fresh one'
    )
    parser.add_argument(
        '--csv',
        type=output_file,
        metavar='FILE',
        help='write the points there: a line "x,y", then one line for each; without --csv and '
        '--plot they are printed',
    )
    parser.add_argument(
        '--plot', type=picture, metavar='FILE.png', help='draw map and points, coloured in order'
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Sample, write the points and the picture, and return the exit code."""
    from hnr_planner.core import sample

    if arguments.csv and arguments.plot and arguments.csv.resolve() == arguments.plot.resolve():
        raise BadInputError(f'--csv and --plot both name {arguments.csv}: choose another name')
    occupancy, space = open_map(arguments)
    keep_map_files(arguments.map, arguments.csv, arguments.plot)
    seed = secrets.randbelow(2**31) if arguments.seed is None else arguments.seed
    compile_kernels()
    start = arguments.start or uniform_start(arguments.map, space, seed)
    (points,) = sample(
        space, start, arguments.n, walk=arguments.walk, thin=arguments.thin, seed=seed
    )

    if arguments.csv:
        with arguments.csv.open('w', encoding='utf-8', newline='') as file:
            write_csv(points, file)
    if arguments.plot:
        from hnr_planner import drawing

        title = f'{arguments.walk}: {arguments.n:,} points, seed {seed}'
        figure = drawing.figure_of_samples(occupancy, points, title=title, blocked=space.blocked)
        drawing.save(figure, arguments.plot)
    if not (arguments.csv or arguments.plot):
        write_csv(points, sys.stdout)
        return 0
    files = ' and '.join(str(file) for file in (arguments.csv, arguments.plot) if file)
    print(f'{arguments.n:,} points ({arguments.walk}, seed {seed}) in {files}')
    return 0


def uniform_start(name: str, space: GridSpace, seed: int) -> NDArray:
    """Return a uniform point (2,) of the largest free component: all its cells are equal."""
    import numpy as np

    rows, cols = np.nonzero(space.largest_component())
    if rows.size == 0:
        raise BadInputError(f'{name}: no free cell is left for the robot')
    rng = np.random.default_rng((seed, 1))  # not the stream of the walk itself
    cell = rng.integers(rows.size)
    in_row, in_col = rng.uniform(-0.5, 0.5, size=2)
    return space.cell_centres(rows[cell] + in_row, cols[cell] + in_col)


def write_csv(points: Iterable[NDArray], file: TextIO) -> None:
    """Write points as a line "x,y" and one line for each, with every digit they have."""
    file.write('x,y\n')
    file.writelines(f'{float(x)!r},{float(y)!r}\n' for x, y in points)
