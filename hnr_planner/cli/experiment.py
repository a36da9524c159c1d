"""The command ``experiment``: measure the paper's claims again."""

from __future__ import annotations

import argparse
from pathlib import Path
import sys
import webbrowser

from hnr_planner.cli.arguments import count

#: Those of the experiments, here so that --help is fast.
NAMES = ('spiral', 'clouds', 'corridor', 'safety', 'mixing', 'theory')
EPILOG = """\
Rows are kept as they come: a run that was broken off goes on where it was, and a longer one
continues a shorter one. A tenth of the runs of docs/ is good for a look. Where HNR_MAPS names a
folder, its map_server maps take part in safety.

examples:
  python -m hnr_planner experiment spiral --runs 50 --show
  python -m hnr_planner experiment --out figures

Exit code 0: done. 2: the arguments are not usable, or the folder holds results of something else.
"""


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command to the command line."""
    parser = commands.add_parser(
        'experiment',
        help="measure the paper's claims again and draw them",
        description='Run experiments: NAME.csv, NAME.svg and NAME.md (the numbers) in a folder.',
        epilog=EPILOG,
    )
    parser.add_argument(
        'names',
        nargs='*',
        metavar='NAME',
        help=f'{", ".join(NAMES)}; default all of them',
    )
    parser.add_argument(
        '--runs',
        type=count,
        metavar='N',
        help='runs of each case, with the seeds 0 to N - 1; default those of docs/',
    )
    parser.add_argument(
        '--out',
        type=Path,
        default=Path('experiments'),
        metavar='DIR',
        help='the folder, made if it is not there; default experiments',
    )
    parser.add_argument(
        '--jobs', type=count, metavar='N', help='runs at the same time; default one on each core'
    )
    parser.add_argument(
        '--fresh',
        action='store_true',
        help='throw away the rows of before, as after a change of the experiment itself',
    )
    parser.add_argument('--show', action='store_true', help='open the figure when it is done')
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Conduct the experiments, print their numbers, and return the exit code."""
    for name in arguments.names or NAMES:
        _conduct(name, arguments)
    return 0


def _conduct(name: str, arguments: argparse.Namespace) -> None:
    from hnr_planner.core.checks import check_choice
    from hnr_planner.experiments import load
    from hnr_planner.experiments.conduct import conduct

    experiment = load(check_choice('experiment', name, NAMES))
    jobs = arguments.jobs or -1
    runs = arguments.runs or experiment.runs
    conduct(experiment, runs, arguments.out, n_jobs=jobs, fresh=arguments.fresh)
    figure = arguments.out / f'{name}.svg'
    print(figure.with_suffix('.md').read_text(encoding='utf-8'))
    print(f'figure      {figure}')
    if arguments.show and not webbrowser.open(figure.resolve().as_uri()):
        print('there is no browser to show it in', file=sys.stderr)
