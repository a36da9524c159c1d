"""
The command line ``hnr-planner``, also ``python -m hnr_planner``.

Each command is a module with ``add_parser``, which declares its arguments, and ``run``, which
runs it and returns the exit code. Large libraries are imported only by ``run``.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
import os
from pathlib import Path
import sys
from typing import Any
import warnings

from hnr_planner import __version__
from hnr_planner.cli import compile as compile_command
from hnr_planner.cli import demo, experiment, plan, sample, tour, watch
from hnr_planner.cli.arguments import BAD_INPUT, BadInputError, CommandParser, error_line
from hnr_planner.core.errors import HnrError

DESCRIPTION = 'Plan paths and draw uniform samples on occupancy maps.'
EPILOG = """\
A MAP is the YAML file of a map_server map, or a .map file of the Moving AI benchmarks.

examples:
  %(prog)s demo
  %(prog)s plan office.yaml --start 2 3 --goal 30 20 --plot plan.png
  %(prog)s sample office.yaml --n 1000 --csv points.csv
"""
#: Exit code after Ctrl-C.
INTERRUPTED = 130


def main(argv: Sequence[str] | None = None) -> int:
    """
    Run one command and return its exit code.

    Parameters
    ----------
    argv : sequence of str, optional
        The arguments; those of the process by default.

    Returns
    -------
    int
        0 for success, 1 when there is no path (or a check of the demo failed), 2 for bad input,
        which one line on stderr explains, 130 when interrupted.

    """
    try:
        arguments = build_parser().parse_args(argv)
    except SystemExit as stop:  # --help, or an error that argparse reported
        return int(stop.code or 0)
    try:
        return _run(arguments)
    except BrokenPipeError:  # the reader, such as ``head``, has ended
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except KeyboardInterrupt:
        return INTERRUPTED


def _run(arguments: Namespace) -> int:
    """Run the command; turn bad input into one line on stderr, and exit code 2."""
    try:
        with _warnings_as_lines():
            code: int = arguments.run(arguments)
        sys.stdout.flush()
        compile_command.note_if_interpreted()
        return code
    except BrokenPipeError:
        raise
    except (BadInputError, HnrError, OSError) as error:
        message = str(error)
    except (MemoryError, OverflowError) as error:
        message = f'too large for this machine: {error or type(error).__name__}'
    print(error_line(message), file=sys.stderr)
    return BAD_INPUT


@contextmanager
def _warnings_as_lines() -> Iterator[None]:
    """
    Print each ``MapFileWarning`` in the block as one line on stderr, without a line of source.

    All other warnings are shown as outside of the block.
    """
    from hnr_planner.maps import MapFileWarning  # imports numpy, which --help does without

    with warnings.catch_warnings():
        warnings.simplefilter('always', MapFileWarning)
        show = warnings.showwarning

        def show_in_one_line(
            message: Warning | str, category: type[Warning], *where: Any, **more: Any
        ) -> None:
            if issubclass(category, MapFileWarning):
                print(f'warning: {message}', file=sys.stderr)
            else:
                show(message, category, *where, **more)

        warnings.showwarning = show_in_one_line
        yield


def _program() -> str:
    """Return how the program was called: ``hnr-planner`` or ``python -m hnr_planner``."""
    called = Path(sys.argv[0]).name
    return called if called == 'hnr-planner' else 'python -m hnr_planner'


def build_parser() -> CommandParser:
    """Return the parser of the whole command line."""
    parser = CommandParser(prog=_program(), description=DESCRIPTION, epilog=EPILOG)
    parser.add_argument('--version', action='version', version=f'hnr_planner {__version__}')
    commands = parser.add_subparsers(title='commands', metavar='COMMAND', required=True)
    for command in (plan, tour, sample, demo, watch, experiment, compile_command):
        command.add_parser(commands)
    return parser
