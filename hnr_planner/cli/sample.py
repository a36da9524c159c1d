"""The command ``sample``: uniform points of the free space of a map."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
import secrets
import sys
from typing import TextIO, TYPE_CHECKING

from hnr_planner.cli.argument_types import count, output_file, picture, positive, whole
from hnr_planner.cli.arguments import (
    add_command,
    add_map_arguments,
    BadInputError,
    keep_map_files,
    open_map,
)
from hnr_planner.cli.extras import require_extra
from hnr_planner.cli.footprint import add_footprint_arguments, pose_space

if TYPE_CHECKING:
    from hnr_planner.core import GridSpace, PoseSpace
    from numpy.typing import NDArray

#: Names of the walks; literal, so that ``--help`` does not import the core. A test compares.
WALK_NAMES = ('hit_and_run', 'coordinate_hit_and_run', 'ball_walk')
EPILOG = """\
example:
  %(prog)s office.yaml --n 1000 --csv points.csv --plot points.png

The points are the states of a random walk. Without --start every point is uniform on all of the
free space: a walk never leaves its connected component, so each component has a walk of its own,
which starts at a uniform point of it, and every point is drawn from the walk of a component chosen
with probability proportional to its area. With --start there is one walk, in the component of the
start, and its first points are still near the start.

Points of one walk are correlated. --thin K takes K steps of the walk for each point, which lowers
the correlation. --chains K draws N points K times, independently; the list then has a third
column, the number of the chain from 0. The same seed gives the same points.

--diagnose prints one line to stderr: how far the chains agree (R-hat) and the number of
independent points that they are worth (effective sample size), or why they should not be taken for
uniform. It needs several chains: use four, and increase --thin or --n until the line reports
convergence.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command ``sample`` to the command line."""
    parser = add_command(
        commands,
        'sample',
        run,
        summary='draw uniform points of the free space of a map',
        description='Draw uniform points of the free space of a map, by a random walk.',
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
        help='longest step of ball_walk [m]; default chosen from the size of the map',
    )
    parser.add_argument(
        '--thin',
        type=count,
        default=1,
        metavar='K',
        help='keep every K-th point of the walk; default 1, every point',
    )
    parser.add_argument(
        '--chains',
        type=count,
        default=1,
        metavar='K',
        help='number of independent chains of N points; default 1',
    )
    parser.add_point('--start', text='start of every chain [m]; default uniform in the free space')
    parser.add_argument(
        '--seed', type=whole, metavar='N', help='seed of the random numbers; default a fresh one'
    )
    parser.add_argument(
        '--diagnose',
        action='store_true',
        help='print convergence and effective sample size to stderr',
    )
    parser.add_argument(
        '--csv',
        type=output_file,
        metavar='FILE',
        help='write the points to this file: a header "x,y" or "x,y,chain", then one line for '
        'each; without --csv and --plot they are printed',
    )
    parser.add_argument(
        '--plot',
        type=picture,
        metavar='FILE.png',
        help='draw map and points, coloured in their order',
    )
    add_footprint_arguments(
        parser,
        'With --footprint the points are poses X Y YAW [m, m, rad] at which the whole outline is\n'
        'free, by a walk along the motions of the robot; --start is a pose, and needed.',
    )


def run(arguments: argparse.Namespace) -> int:
    """
    Draw the points, write them and the picture, and return the exit code.

    The points are printed where neither ``--csv`` nor ``--plot`` names a file.
    """
    from hnr_planner.core import diagnose

    if arguments.csv and arguments.plot and arguments.csv.resolve() == arguments.plot.resolve():
        raise BadInputError(f'--csv and --plot both name {arguments.csv}: choose another name')
    if arguments.plot:
        require_extra('plot', '--plot')
    occupancy, grid = open_map(arguments)
    space = pose_space(arguments, grid)
    keep_map_files(arguments.map, arguments.csv, arguments.plot)
    seed = secrets.randbelow(2**31) if arguments.seed is None else arguments.seed
    chains = _draw(arguments, grid if space is None else space, seed)
    if arguments.diagnose:
        print(diagnose(chains).message, file=sys.stderr)

    if arguments.csv:
        with arguments.csv.open('w', encoding='utf-8', newline='') as file:
            write_csv(chains, file)
    if arguments.plot:
        from hnr_planner import drawing

        figure = drawing.figure_of_samples(
            occupancy,
            chains.reshape(-1, chains.shape[2])[:, :2],
            title=f'{arguments.walk}: {_how_many(arguments)}, seed {seed}',
            blocked=grid.blocked if space is None else grid.uninflated,
        )
        drawing.save(figure, arguments.plot)
    if not (arguments.csv or arguments.plot):
        write_csv(chains, sys.stdout)
        return 0
    files = ' and '.join(str(file) for file in (arguments.csv, arguments.plot) if file)
    print(f'{_how_many(arguments)} ({arguments.walk}, seed {seed}) in {files}')
    return 0


def _draw(arguments: argparse.Namespace, space: GridSpace | PoseSpace, seed: int) -> NDArray:
    """Return the requested chains of points (n_chains, n, 2) [m], or of poses (n_chains, n, 3)."""
    from hnr_planner.core import BallWalk, PoseSpace, sample, sample_free_space, SpaceError

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
    if isinstance(space, PoseSpace):
        raise BadInputError('--footprint needs --start X Y YAW')
    try:
        return sample_free_space(space, arguments.n, **settings).points
    except SpaceError as error:
        raise BadInputError(f'{arguments.map}: there is nothing to sample, {error}') from error


def _how_many(arguments: argparse.Namespace) -> str:
    """Return the requested number of points, for titles and messages."""
    chains = f'{arguments.chains:,} chains of ' if arguments.chains > 1 else ''
    return f'{chains}{arguments.n:,} points'


def write_csv(chains: NDArray, file: TextIO) -> None:
    """
    Write chains (n_chains, n, 2) or (n_chains, n, 3) as CSV, one line for each point or pose.

    All digits are written. Several chains have a last column: the number of the chain, from 0.
    """
    names = ['x', 'y', 'yaw'][: chains.shape[2]]
    if len(chains) == 1:
        file.write(','.join(names) + '\n')
        file.writelines(f'{row}\n' for row in _rows(chains[0]))
        return
    file.write(','.join([*names, 'chain']) + '\n')
    for k, chain in enumerate(chains):
        file.writelines(f'{row},{k}\n' for row in _rows(chain))


def _rows(points: NDArray) -> Iterator[str]:
    """Yield the numbers of each point of an array (n, dim) as text, separated by commas."""
    return (','.join(map(repr, point)) for point in points.tolist())
