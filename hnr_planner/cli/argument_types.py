"""Types of arguments for argparse: numbers within bounds, and files to write."""

import argparse
from collections.abc import Callable
import math
from pathlib import Path
from typing import TypeVar

Number = TypeVar('Number', int, float)

#: File name endings of pages and of pictures.
PAGES = ('.html', '.htm')
PICTURES = ('.png', '.svg', '.pdf')
#: Names of number types, for messages.
KINDS = {float: 'number', int: 'whole number'}


def bounded(
    kind: type[Number],
    *,
    least: float = -math.inf,
    above: float = -math.inf,
    most: float = math.inf,
) -> Callable[[str], Number]:
    """
    Return a function that converts text to a finite number within bounds, for argparse.

    The number is of the type ``kind``, at least ``least``, greater than ``above`` and at most
    ``most``; for any other text the function raises ArgumentTypeError.
    """

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
    """
    Return the path of a picture to write, for argparse.

    ArgumentTypeError is raised where its folder does not exist, it is a folder itself, or its name
    ends in none of ``PICTURES``.
    """
    return _output_file_in(PICTURES, text)


def page(text: str) -> Path:
    """
    Return the path of an HTML page to write, for argparse.

    ArgumentTypeError is raised where its folder does not exist, it is a folder itself, or its name
    ends in none of ``PAGES``.
    """
    return _output_file_in(PAGES, text)


def _output_file_in(endings: tuple[str, ...], text: str) -> Path:
    """Return the path of a file to write whose name ends in one of ``endings``, for argparse."""
    file = output_file(text)
    if file.suffix.lower() not in endings:
        raise argparse.ArgumentTypeError(f'{text!r} does not end in one of {", ".join(endings)}')
    return file


def output_file(text: str) -> Path:
    """
    Return the path of a file to write, for argparse.

    ArgumentTypeError is raised where its folder does not exist, or it is a folder itself.
    """
    file = Path(text)
    if not file.parent.is_dir():
        raise argparse.ArgumentTypeError(f'there is no folder {str(file.parent)!r}')
    if file.is_dir():
        raise argparse.ArgumentTypeError(f'{text!r} is a folder')
    return file
