"""Kernels picked by the type of their first argument, compiled and interpreted alike."""

from typing import Any, NamedTuple

from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import interpreted, kernel
import pytest


class Square(NamedTuple):
    side: float


class Segment(NamedTuple):
    length: float


class Pair(NamedTuple):
    """Two shapes, which may be pairs as well."""

    one: Any
    other: Any


@dispatched
@kernel
def area(shape: Any, scale: float) -> float:
    """Return the area of a shape; 0 unless it has one."""
    return 0.0


@area.register(Square)
@kernel
def _area_of_square(square, scale):
    return (square.side * scale) ** 2


@area.register(Pair)
@kernel
def _area_of_pair(pair, scale):
    return area(pair.one, scale) + area(pair.other, scale)


@kernel
def twice_the_area(shape, scale):
    return 2.0 * area(shape, scale)


NESTED = Pair(Pair(Square(1.0), Segment(7.0)), Pair(Square(2.0), Pair(Square(3.0), Square(0.5))))


@pytest.mark.parametrize(
    ('shape', 'expected'),
    [(Square(3.0), 36.0), (Segment(3.0), 0.0), (NESTED, 4.0 * (1.0 + 4.0 + 9.0 + 0.25))],
    ids=['registered', 'by default', 'parts of parts'],
)
def test_compiled_and_interpreted_code_find_the_kernel(shape, expected):
    scale = 2.0**0.5
    assert twice_the_area(shape, scale) == pytest.approx(expected)
    assert interpreted(twice_the_area)(shape, scale) == pytest.approx(expected)
    assert 2.0 * area(shape, scale) == pytest.approx(expected)


def test_it_tells_for_which_types_it_has_a_kernel():
    assert area.knows(Square(1.0))
    assert not area.knows(Segment(1.0))


def test_it_keeps_its_name_and_what_it_says_of_itself():
    assert area.__name__ == 'area'
    assert area.__doc__.startswith('Return the area')
