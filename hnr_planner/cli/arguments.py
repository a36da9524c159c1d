"""
The parser of commands, arguments that several of them share, and errors of one line.

Importing this module is fast: the modules of maps and planners, with NumPy, are imported only when
a map is opened.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Sequence
from itertools import takewhile
from pathlib import Path
import re
import sys
from typing import Any, NoReturn, Protocol, TYPE_CHECKING

from hnr_planner.cli.argument_types import length, number

if TYPE_CHECKING:
    from hnr_planner.core import GridSpace
    from hnr_planner.maps import OccupancyMap

#: Exit code for bad input.
BAD_INPUT = 2
#: The option with which points are poses, and the numbers of a point and of a pose.
FOOTPRINT, POINT, POSE = '--footprint', ('X', 'Y'), ('X', 'Y', 'YAW')
#: Numbers in words.
NUMBER_WORDS = {2: 'two', 3: 'three'}


class Listed(Protocol):
    """Entry of a registry, such as a planner, that a help text lists."""

    @property
    def name(self) -> str:
        """Return the name that the command line takes."""

    @property
    def summary(self) -> str:
        """Return one line that describes the entry."""


class BadInputError(ValueError):
    """
    Error that a well-formed argument cannot be used, or that a command lacks what it needs.

    The message names the argument or the command, and the reason.
    """


class CommandParser(argparse.ArgumentParser):
    """An argument parser that reports an error in one line and keeps the layout of its epilog."""

    def __init__(self, **settings: object) -> None:
        """
        Make a parser with the settings of ``argparse.ArgumentParser``.

        ``allow_abbrev`` is always False: options cannot be abbreviated.
        """
        settings.setdefault('formatter_class', argparse.RawDescriptionHelpFormatter)
        settings['allow_abbrev'] = False
        super().__init__(**settings)  # type: ignore[arg-type]
        # argparse takes -1e-3, which Python itself prints, for an option.
        self._negative_number_matcher = re.compile(r'^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$|^-inf$')
        self._points: dict[str, argparse.Action] = {}

    def add_point(self, option: str, *, required: bool = False, text: str) -> None:
        """
        Add an option that takes a point X Y [m]; ``text`` describes it in ``--help``.

        Where the command is given ``--footprint``, the option takes a pose X Y YAW [m, m, rad].
        """
        self._points[option] = self.add_argument(
            option, type=number, nargs=2, metavar=('X', 'Y'), required=required, help=text
        )

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> tuple[Any, list[str]]:
        """
        Parse the arguments, after a check that each option for a point is followed by two numbers.

        With ``--footprint`` they are three. The check comes first because its message has an
        example, which that of argparse has not.
        """
        words = sys.argv[1:] if args is None else list(args)
        names = POSE if any(word.partition('=')[0] == FOOTPRINT for word in words) else POINT
        for action in self._points.values():
            action.nargs, action.metavar = len(names), names
        for place, word in enumerate(words, start=1):
            option, equals, first = word.partition('=')
            if option in self._points:
                given = [*([first] if equals else []), *words[place:]]
                self._check_point(option, given, names)
        return super().parse_known_args(words, namespace)

    def _check_point(self, option: str, words: Sequence[str], names: tuple[str, ...]) -> None:
        """
        Report an error where other than a number for each of ``names`` follows an option.

        ``words`` are the words after the option, which is one for a point. Nothing is done where
        the first of them holds no number: argparse reports that.
        """
        given = list(takewhile(_numbers_in, words))
        if not given:
            return  # argparse names the word that is no number
        count, wanted = len(given), len(names)
        follower = words[count] if count < len(words) else '--'
        numbers = [number for word in given for number in _numbers_in(word)]
        too_few = count < wanted and follower.startswith('--')
        if numbers != given or count > wanted or too_few:
            example = ' '.join((*numbers, '0.5', '0.5')[:wanted])
            *first, last = names
            self.error(
                f'argument {option}: takes {NUMBER_WORDS[wanted]} numbers, {", ".join(first)} and '
                f'{last}, such as {option} {example}; not {" ".join(given)}'
            )

    def error(self, message: str) -> NoReturn:
        """Print the message as one line on stderr, and raise SystemExit with exit code 2."""
        print(error_line(f'{message} (see {self.prog} --help)'), file=sys.stderr)
        raise SystemExit(BAD_INPUT)


def _numbers_in(word: str) -> list[str]:
    """
    Return the numbers, as text, of a word such as ``.5,.5``.

    The list is empty where the word holds anything but numbers, separators and brackets.
    """
    parts = [part for part in re.split(r'[,;()\[\]\s]+', word) if part]
    try:
        return parts if [float(part) for part in parts] else []
    except ValueError:
        return []


def add_command(
    commands: argparse._SubParsersAction,
    name: str,
    run: Callable[[argparse.Namespace], int],
    *,
    summary: str,
    description: str,
    epilog: str,
) -> CommandParser:
    """
    Add a command to the command line, and return its parser.

    Parameters
    ----------
    commands
        The subparsers of the command line.
    name : str
        Name of the command.
    run : callable
        Runs it, given the parsed arguments, and returns the exit code.
    summary, description, epilog : str
        A line for the list of commands; first and last part of the command's own help.

    """
    parser: CommandParser = commands.add_parser(
        name, help=summary, description=description, epilog=epilog
    )
    parser.set_defaults(run=run)
    return parser


def listing(entries: Iterable[Listed]) -> str:
    """
    Return one line for each entry, its name and summary, for a help text of argparse.

    There has to be at least one entry; every ``%`` is doubled, as argparse needs it.
    """
    entries = list(entries)
    width = max(len(entry.name) for entry in entries)
    lines = (f'  {entry.name:<{width}}  {entry.summary}' for entry in entries)
    return '\n'.join(lines).replace('%', '%%')


def error_line(message: str) -> str:
    """Return an error message as one line that begins with ``error:``."""
    return 'error: ' + ' '.join(message.split())


def add_map_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments MAP, ``--robot-radius`` and ``--unknown`` to a command's parser."""
    parser.add_argument(
        'map',
        metavar='MAP',
        help='the YAML file of a map_server map, or a .map file of the Moving AI benchmarks '
        '(ground and swamp are free; water, trees and all else are blocked)',
    )
    parser.add_argument(
        '--robot-radius',
        type=length,
        default=0.0,
        metavar='R',
        help='radius of the robot, which is a circle [m]; default 0, a point',
    )
    parser.add_argument(
        '--unknown',
        choices=('blocked', 'free'),
        default='blocked',
        help='whether unknown cells are blocked or free; default blocked',
    )


def open_map(arguments: argparse.Namespace) -> tuple[OccupancyMap, GridSpace]:
    """
    Return the map that the arguments name, and the free space of the robot on it.

    ``arguments`` has what ``add_map_arguments`` declares. MapFileError is raised where the map
    cannot be read.
    """
    from hnr_planner.core import GridSpace
    from hnr_planner.maps import load_map

    occupancy = load_map(arguments.map)
    space = GridSpace.from_occupancy(
        occupancy.data,
        occupancy.resolution,
        occupancy.origin,
        robot_radius=arguments.robot_radius,
        unknown=arguments.unknown,
    )
    return occupancy, space


def keep_map_files(map_file: str | Path, *outputs: Path | None) -> None:
    """
    Refuse outputs that would overwrite a file of the map.

    The image of ``office.yaml``, for example, is often ``office.png``. An output may be None.

    Raises
    ------
    BadInputError
        When an output is the map file, or the image that it names.

    """
    from hnr_planner.maps import is_moving_ai
    from hnr_planner.maps.map_header import read_header

    inputs = [Path(map_file)]
    if not is_moving_ai(map_file):
        inputs.append(read_header(inputs[0]).image)
    for output in filter(None, outputs):
        for file in inputs:
            if output.exists() and file.exists() and output.samefile(file):
                raise BadInputError(f'{output} belongs to the map {map_file}: choose another name')
