"""
What the commands have in common: arguments with a type and a unit, and one line for an error.

Importing this is cheap; the map and the planner are imported when a map is opened.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
import math
from pathlib import Path
import re
import sys
import threading
from typing import NoReturn, TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from hnr_planner.core import GridSpace
    from hnr_planner.maps import OccupancyMap

Number = TypeVar('Number', int, float)

BAD_INPUT = 2
PAGES = ('.html', '.htm')
PICTURES = ('.png', '.svg', '.pdf')
KINDS = {float: 'number', int: 'whole number'}
PATIENCE = 2.0
"""How long the kernels may take to load before we say what we wait for [s]."""


class BadInputError(ValueError):
    """An argument is well-formed but cannot be used; the message names it, and why."""


class CommandParser(argparse.ArgumentParser):
    """An argument parser that reports an error in one line and keeps the layout of its epilog."""

    def __init__(self, **settings: object) -> None:
        """Take what argparse takes."""
        settings.setdefault('formatter_class', argparse.RawDescriptionHelpFormatter)
        settings['allow_abbrev'] = False
        super().__init__(**settings)  # type: ignore[arg-type]
        # argparse takes -1e-3, which Python itself prints, for an option.
        self._negative_number_matcher = re.compile(r'^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$|^-inf$')

    def error(self, message: str) -> NoReturn:
        """Print one line and end with exit code 2."""
        print(error_line(f'{message} (see {self.prog} --help)'), file=sys.stderr)
        raise SystemExit(BAD_INPUT)


def error_line(message: str) -> str:
    """Return an error message as one line."""
    return 'error: ' + ' '.join(message.split())


def bounded(
    kind: type[Number],
    *,
    least: float = -math.inf,
    above: float = -math.inf,
    most: float = math.inf,
) -> Callable[[str], Number]:
    """Return what reads a finite number of a kind, and within bounds, for argparse."""

    def read(text: str) -> Number:
        try:
            value = kind(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f'{text!r} is not a {KINDS[kind]}') from None
        if not -math.inf < value < math.inf:
            raise argparse.ArgumentTypeError(f'{text!r} is not a finite number')
        if value < least:
            raise argparse.ArgumentTypeError(f'{text} is less than {least}')
        if value <= above:
            raise argparse.ArgumentTypeError(f'{text} is not above {above}')
        if value > most:
            raise argparse.ArgumentTypeError(f'{text} is more than {most}')
        return value

    return read


number = bounded(float)
length = bounded(float, least=0)
positive = bounded(float, above=0)
whole = bounded(int, least=0)
count = bounded(int, least=1, most=10**9)


def picture(text: str) -> Path:
    """Return the path of a picture that can be written, for argparse."""
    file = output_file(text)
    if file.suffix.lower() not in PICTURES:
        raise argparse.ArgumentTypeError(f'{text!r} does not end in one of {", ".join(PICTURES)}')
    return file


def page(text: str) -> Path:
    """Return the path of a page that can be written, for argparse."""
    file = output_file(text)
    if file.suffix.lower() not in PAGES:
        raise argparse.ArgumentTypeError(f'{text!r} does not end in one of {", ".join(PAGES)}')
    return file


def output_file(text: str) -> Path:
    """Return the path of a file whose folder is there, for argparse."""
    file = Path(text)
    if not file.parent.is_dir():
        raise argparse.ArgumentTypeError(f'there is no folder {str(file.parent)!r}')
    if file.is_dir():
        raise argparse.ArgumentTypeError(f'{text!r} is a folder')
    return file


def add_map_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the map and how it becomes a space."""
    parser.add_argument(
        'map',
        metavar='MAP',
        help='the YAML file of a map_server map, or a .map file of the Moving AI benchmarks',
    )
    parser.add_argument(
        '--robot-radius',
        type=length,
        default=0.0,
        metavar='R',
        help='the robot is a circle of this radius [m]; default 0, a point',
    )
    parser.add_argument(
        '--unknown',
        choices=('blocked', 'free'),
        default='blocked',
        help='what cells are of which the map knows nothing; default blocked',
    )


def open_map(arguments: argparse.Namespace) -> tuple[OccupancyMap, GridSpace]:
    """Return the map that the arguments name and the space of a robot on it."""
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
    Refuse to write over a file of the map: ``office.yaml`` mostly has its image in ``office.png``.

    Raises
    ------
    BadInputError
        When an output is the map file or its image.

    """
    from hnr_planner.maps.map_server import read_header

    inputs = [Path(map_file)]
    if inputs[0].suffix.lower() != '.map':
        inputs.append(read_header(inputs[0]).image)
    for output in filter(None, outputs):
        for file in inputs:
            if output.exists() and file.exists() and output.samefile(file):
                raise BadInputError(f'{output} belongs to the map {map_file}: choose another name')


def compile_kernels(use: str) -> None:
    """Have the kernels for a use ready before anything is timed; say so when that takes long."""
    from hnr_planner.core import warm_up

    note = 'loading compiled code; the first time it is compiled, a minute or two ...'
    timer = threading.Timer(PATIENCE, print, [note], {'file': sys.stderr, 'flush': True})
    timer.daemon = True
    timer.start()
    try:
        warm_up(use)
    finally:
        timer.cancel()
