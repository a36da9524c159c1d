"""The command ``sample``: uniform points of the free part of a map."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
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
    positive,
    whole,
)

if TYPE_CHECKING:
    from hnr_planner.core import GridSpace
    from numpy.typing import NDArray

# Those of the core; see plan.py.
WALK_NAMES = ('hit_and_run', 'coordinate_hit_and_run', 'ball_walk')
EPILOG = """\
example:
  python -m hnr_planner sample office.yaml --n 1000 --csv points.csv --plot points.png

The points are those of a random walk. Left to itself, it draws from all of the free space, and
every point is uniform there. No walk leads from one connected part to another, so there is one in
each, which starts at a uniform point of it; at every point the walk of one part moves on, picked
with the probability of its share of the area. With --start there is a walk in the part in which
the start lies, and the first points are still near the start.

Points of one walk depend on each other. --thin K lets the walk take K steps for each point: the
points depend less on each other. --chains K draws N points K times, independently; the list then
has a third column, the number of the chain from 0. The same seed gives the same points.

--diagnose says on one line of stderr what the points are worth: how far the chains agree (R-hat)
and how many independent points they are as good as, or why they should not be taken for uniform.
One chain alone cannot show that: take four, and a larger --thin or --n until the line says so.
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
        '--radius',
        type=positive,
        metavar='R',
        help='longest step of ball_walk [m]; default what suits the map',
    )
    parser.add_argument(
        '--thin',
        type=count,
        default=1,
        metavar='K',
        help='keep every K-th point of the walk and drop those between; default 1, every point',
    )
    parser.add_argument(
        '--chains',
        type=count,
        default=1,
        metavar='K',
        help='draw N points so many times, independently of each other; default 1',
    )
    parser.add_argument(
        '--start',
        type=number,
        nargs=2,
        metavar=('X', 'Y'),
        help='where every chain starts [m]; default anywhere in the free space',
    )
    parser.add_argument(
        '--seed', type=whole, metavar='N', help='seed of the random numbers; default a fresh one'
    )
    parser.add_argument(
        '--diagnose', action='store_true', help='say on stderr what the points are worth'
    )
    parser.add_argument(
        '--csv',
        type=output_file,
        metavar='FILE',
        help='write the points there: a line "x,y", or "x,y,chain", then one line for each; '
        'without --csv and --plot they are printed',
    )
    parser.add_argument(
        '--plot', type=picture, metavar='FILE.png', help='draw map and points, coloured in order'
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Sample, write the points and the picture, and return the exit code."""
    from hnr_planner.core import diagnose

    if arguments.csv and arguments.plot and arguments.csv.resolve() == arguments.plot.resolve():
        raise BadInputError(f'--csv and --plot both name {arguments.csv}: choose another name')
    occupancy, space = open_map(arguments)
    keep_map_files(arguments.map, arguments.csv, arguments.plot)
    seed = secrets.randbelow(2**31) if arguments.seed is None else arguments.seed
    compile_kernels('samples')
    chains = _draw(arguments, space, seed)
    if arguments.diagnose:
        print(diagnose(chains).message, file=sys.stderr)

    if arguments.csv:
        with arguments.csv.open('w', encoding='utf-8', newline='') as file:
            write_csv(chains, file)
    if arguments.plot:
        from hnr_planner import drawing

        figure = drawing.figure_of_samples(
            occupancy,
            chains.reshape(-1, 2),
            title=f'{arguments.walk}: {_how_many(arguments)}, seed {seed}',
            blocked=space.blocked,
        )
        drawing.save(figure, arguments.plot)
    if not (arguments.csv or arguments.plot):
        write_csv(chains, sys.stdout)
        return 0
    files = ' and '.join(str(file) for file in (arguments.csv, arguments.plot) if file)
    print(f'{_how_many(arguments)} ({arguments.walk}, seed {seed}) in {files}')
    return 0


def _draw(arguments: argparse.Namespace, space: GridSpace, seed: int) -> NDArray:
    """Return the chains of points (k, n, 2) that are asked for."""
    from hnr_planner.core import BallWalk, sample, sample_free_space, SpaceError

    if arguments.radius is not None and arguments.walk != BallWalk.name:
        raise BadInputError(f'--radius is for --walk {BallWalk.name} only')
    walk = BallWalk(arguments.radius) if arguments.walk == BallWalk.name else arguments.walk
    settings = {
        'walk': walk,
        'n_chains': arguments.chains,
        'thin': arguments.thin,
        'seed': seed,
    }
    if arguments.start is not None:
        return sample(space, arguments.start, arguments.n, **settings)
    try:
        return sample_free_space(space, arguments.n, **settings).points
    except SpaceError as error:
        raise BadInputError(f'{arguments.map}: nothing to draw from, {error}') from error


def _how_many(arguments: argparse.Namespace) -> str:
    """Return how many points are asked for, in words."""
    chains = f'{arguments.chains:,} chains of ' if arguments.chains > 1 else ''
    return f'{chains}{arguments.n:,} points'


def write_csv(chains: NDArray, file: TextIO) -> None:
    """Write chains (k, n, 2) as "x,y" and a line for each point, with every digit they have."""
    if len(chains) == 1:
        file.write('x,y\n')
        file.writelines(f'{x!r},{y!r}\n' for x, y in _numbers(chains[0]))
        return
    file.write('x,y,chain\n')
    for k, chain in enumerate(chains):
        file.writelines(f'{x!r},{y!r},{k}\n' for x, y in _numbers(chain))


def _numbers(points: NDArray) -> Iterator[tuple[float, float]]:
    """Yield points (n, 2) as numbers of Python."""
    return ((float(x), float(y)) for x, y in points)
