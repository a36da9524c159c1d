"""
The command line ``python -m hnr_planner``.

Each command is a module with ``add_parser``, which says what the command takes, and ``run``,
which does it and returns the exit code. They import what is heavy only when they run.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
import os
import sys

from hnr_planner import __version__
from hnr_planner.cli import demo, experiment, plan, sample
from hnr_planner.cli.arguments import BAD_INPUT, BadInputError, CommandParser, error_line

DESCRIPTION = 'Plan paths and draw uniform samples on occupancy maps.'
EPILOG = """\
A MAP is the YAML file of a map_server map, or a .map file of the Moving AI benchmarks.

examples:
  python -m hnr_planner demo
  python -m hnr_planner plan office.yaml --start 2 3 --goal 30 20 --plot plan.png
  python -m hnr_planner sample office.yaml --n 1000 --csv points.csv
"""
INTERRUPTED = 130


def main(argv: Sequence[str] | None = None) -> int:
    """
    Run one command and return its exit code.

    Parameters
    ----------
    argv : sequence of str, optional
        The arguments, those of the process when left out.

    Returns
    -------
    int
        0 when all went well, 1 when there is no path (or a check of the demo failed), 2 for bad
        input, which one line on stderr explains, 130 when interrupted.

    """
    try:
        arguments = build_parser().parse_args(argv)
    except SystemExit as stop:  # --help, or what argparse found wrong
        return int(stop.code or 0)
    try:
        return _run(arguments)
    except BrokenPipeError:  # the reader, such as `head`, has had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        return INTERRUPTED


def _run(arguments: Namespace) -> int:
    """Run the command; bad input becomes one line and its exit code."""
    from hnr_planner.core.errors import HnrError  # heavy, and --help should be fast

    try:
        code: int = arguments.run(arguments)
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        raise
    except (BadInputError, HnrError, OSError) as error:
        message = str(error)
    except (MemoryError, OverflowError) as error:
        message = f'too large for this machine: {error or type(error).__name__}'
    print(error_line(message), file=sys.stderr)
    return BAD_INPUT


def build_parser() -> CommandParser:
    """Return the parser of the whole command line."""
    parser = CommandParser(prog='python -m hnr_planner', description=DESCRIPTION, epilog=EPILOG)
    parser.add_argument('--version', action='version', version=f'hnr_planner {__version__}')
    commands = parser.add_subparsers(title='commands', metavar='COMMAND', required=True)
    for command in (plan, sample, demo, experiment):
        command.add_parser(commands)
    return parser
