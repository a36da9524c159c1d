"""The command ``experiment``: repeat the paper's experiments."""

from __future__ import annotations

import argparse
from contextlib import nullcontext
import os
from pathlib import Path
import sys
import webbrowser

from hnr_planner.cli.argument_types import count
from hnr_planner.cli.arguments import add_command, listing
from hnr_planner.cli.extras import require_extra
from hnr_planner.experiments.registry import EXPERIMENTS, load, NAMES

EPILOG = """\
Rows are saved as they are measured: an interrupted run resumes, and a longer run continues a
shorter one. A tenth of the runs of docs/ is enough for a first look. When HNR_MAPS names a folder,
the experiment safety includes its map_server maps.

examples:
  %(prog)s spiral --runs 50 --show
  %(prog)s --out figures
  %(prog)s mixing --dask tcp://10.0.0.5:8786

experiments:
{experiments}

Exit code 0: done. 2: the arguments are not usable, the folder holds results of other sources, or
a cluster cannot be reached or has other versions.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command ``experiment`` to the command line."""
    parser = add_command(
        commands,
        'experiment',
        run,
        summary="measure the paper's claims and draw figures",
        description='Run experiments: NAME.csv, NAME.svg and NAME.md (tables) in a folder.',
        epilog=EPILOG.format(experiments=listing(EXPERIMENTS.values())),
    )
    parser.add_argument(
        'names',
        nargs='*',
        metavar='NAME',
        help='one of the experiments below; default all of them',
    )
    parser.add_argument(
        '--runs',
        type=count,
        metavar='N',
        help='runs of each case, with the seeds 0 to N - 1; default as in docs/',
    )
    parser.add_argument(
        '--out',
        type=Path,
        default=Path('experiments'),
        metavar='DIR',
        help='the output folder, created if it does not exist; default experiments',
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument(
        '--jobs', type=count, metavar='N', help='parallel runs; default one for each core'
    )
    where.add_argument(
        '--dask',
        metavar='ADDRESS',
        help='run on the workers of a Dask scheduler instead, with the same rows',
    )
    parser.add_argument(
        '--fresh',
        action='store_true',
        help='discard the rows saved before, as after a change of the experiment itself',
    )
    parser.add_argument('--show', action='store_true', help='open the figure in a browser')


def run(arguments: argparse.Namespace) -> int:
    """
    Run the experiments that were named, or else all, and return the exit code.

    The tables of each are printed as it ends.
    """
    from hnr_planner.core.kernels import modes

    require_extra('experiments', 'an experiment')
    if arguments.dask is not None:
        require_extra('cluster', '--dask')
    from hnr_planner.experiments.cluster import on_cluster

    # Interpreted, an experiment would take days: all its processes wait for machine code.
    modes.set_mode(os.environ.get(modes.VARIABLE) or modes.Mode.COMPILED)
    with nullcontext() if arguments.dask is None else on_cluster(arguments.dask):
        for name in arguments.names or NAMES:
            _conduct(name, arguments)
    return 0


def _conduct(name: str, arguments: argparse.Namespace) -> None:
    """Run one experiment, print its tables, and with ``--show`` open its figure in a browser."""
    from hnr_planner.core.checks import check_choice
    from hnr_planner.experiments.conduct import conduct

    experiment = load(check_choice('experiment', name, NAMES))
    jobs = arguments.jobs or -1
    runs = arguments.runs or experiment.runs
    conduct(experiment, runs, arguments.out, n_jobs=jobs, fresh=arguments.fresh)
    figure = arguments.out / f'{name}.svg'
    print(figure.with_suffix('.md').read_text(encoding='utf-8'))
    print(f'figure      {figure}')
    if arguments.show and not webbrowser.open(figure.resolve().as_uri()):
        print('no browser was found to show it', file=sys.stderr)
