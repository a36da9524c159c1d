"""Every corridor is one piece, as wide as asked for, from its start to its goal."""

from collections.abc import Callable
from typing import Any

import cv2
from hnr_planner.maps import Corridor, serpentine, spiral, zigzag
import numpy as np
from numpy.typing import NDArray
import pytest

WIDTHS = (0.4, 0.6, 0.8, 1.0, 1.2, 1.6, 2.0, 2.4)
FAT = ((0.4, 2.4), (0.6, 1.8), (1.2, 2.4), (1.6, 2.4))
EVEN = [(spiral, width) for width in WIDTHS]
EVEN += [(build, width) for build in (serpentine, zigzag) for width in (0.5, 1.0, 1.5, 2.0, 3.0)]


def words(parameters: tuple[Any, ...]) -> str:
    build, *widths = parameters
    return f'{build.__name__} {widths}'


@pytest.fixture(params=EVEN + [(spiral, *widths) for widths in FAT], ids=words)
def made(request: pytest.FixtureRequest) -> Corridor:
    build, width, *middle = request.param
    return build(width, middle_width=middle[0]) if middle else build(width)


def pieces(mask: NDArray[np.bool_], connectivity: int = 4) -> int:
    """Count the connected pieces of a mask."""
    return cv2.connectedComponents(mask.astype(np.uint8), connectivity=connectivity)[0] - 1


def opened(mask: NDArray[np.bool_], side: int) -> NDArray[np.bool_]:
    """Return the cells covered by squares of this side that fit into the mask."""
    square = np.ones((side, side), np.uint8)
    walled = np.pad(mask, side).astype(np.uint8)
    corners = cv2.erode(walled, square, anchor=(0, 0))
    covered = cv2.dilate(corners, square, anchor=(side - 1, side - 1))
    return covered[side:-side, side:-side] > 0


def cell(made: Corridor, point: tuple[float, float]) -> tuple[int, int]:
    x, y = point
    return int(y / made.resolution), int(x / made.resolution)


def test_free_cells_are_one_piece_without_a_hole(made: Corridor) -> None:
    assert pieces(~made.blocked) == 1
    walled = np.pad(made.blocked, 1, constant_values=True)
    assert pieces(walled, connectivity=8) == 1


def test_map_of_a_corridor_is_free_where_it_is_not_blocked(made: Corridor) -> None:
    assert np.array_equal(made.occupancy.data, np.where(made.blocked, 100, 0))
    assert made.occupancy.resolution == made.resolution


def steps_from(made: Corridor, point: tuple[float, float]) -> NDArray[np.int_]:
    """Return the number of steps to each free cell from a point, -1 for blocked cells."""
    blocked = np.pad(made.blocked, 1, constant_values=True)
    steps = np.full(blocked.shape, -1)
    row, column = cell(made, point)
    front = [(row + 1, column + 1)]
    steps[front[0]] = 0
    while front:
        reached = []
        for row, column in front:
            around = ((row + 1, column), (row - 1, column), (row, column + 1), (row, column - 1))
            for place in around:
                if not blocked[place] and steps[place] < 0:
                    steps[place] = steps[row, column] + 1
                    reached.append(place)
        front = reached
    return steps[1:-1, 1:-1]


def test_goal_is_the_far_end_of_the_corridor(made: Corridor) -> None:
    steps = steps_from(made, made.start)
    # Behind the goal there is only the end of the corridor: half a square of its width.
    beyond = (steps.max() - steps[cell(made, made.goal)]) * made.resolution
    assert 0 < beyond <= 2 * made.goal_radius


def test_corridor_is_nowhere_narrower_than_asked(made: Corridor) -> None:
    width = round(2 * made.goal_radius / made.resolution)
    assert np.array_equal(opened(~made.blocked, width), ~made.blocked)


@pytest.mark.parametrize(('build', 'width'), EVEN)
def test_corridor_is_nowhere_wider_than_asked(
    build: Callable[[float], Corridor], width: float
) -> None:
    made = build(width)
    assert made.goal_radius == pytest.approx(width / 2)
    side = round(width / made.resolution) + 1
    assert not opened(~made.blocked, side).any()


@pytest.mark.parametrize(('width', 'middle_width'), FAT)
def test_one_arm_is_fatter(width: float, middle_width: float) -> None:
    made = spiral(width, middle_width=middle_width)
    for side, arms in ((middle_width, 1), (middle_width + 0.04, 0), (width + 0.04, 1)):
        assert pieces(opened(~made.blocked, round(side / made.resolution))) == arms


@pytest.mark.parametrize('width', WIDTHS)
def test_start_is_at_the_bottom_left_and_leads_up(width: float) -> None:
    made = spiral(width)
    assert made.start == pytest.approx((0.1 + width / 2, 0.1 + width / 2))
    row, column = cell(made, made.start)
    free = ~made.blocked
    edge = np.concatenate([free[[0, -1]].ravel(), free[:, [0, -1]].ravel()])
    assert not edge.any()
    assert np.flatnonzero(free[:, column])[0] == 5
    assert free[row:-5, column].all()
    beside = column + round(width / made.resolution)
    assert not free[row, column:beside].all()


def test_lengths_are_rounded_to_cells() -> None:
    made = spiral(1.004, resolution=0.05, size=5.02)
    assert made.blocked.shape == (100, 100)
    assert made.goal_radius == pytest.approx(0.5)


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        ({'width': 0.0}, 'width must be finite and at least half a cell, not 0.0'),
        ({'width': float('nan')}, 'width must be finite'),
        ({'width': 1.0, 'wall': 0.001}, 'wall must be'),
        ({'width': 1.0, 'size': float('inf')}, 'size must be'),
        ({'width': 1.0, 'resolution': 0.0}, 'resolution must be'),
        ({'width': 1.0, 'middle_width': 0.0}, 'middle_width must be'),
        ({'width': 9.9}, 'a corridor of width 9.9 does not fit into a square of 10.0'),
        ({'width': 1.0, 'middle_width': 9.0}, 'a middle arm of width 9.0 does not fit'),
    ],
)
def test_lengths_that_make_no_spiral(arguments: dict[str, float], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        spiral(**arguments)


@pytest.mark.parametrize(
    ('build', 'width', 'most'),
    [
        (serpentine, 0.0, '5.00'),
        (serpentine, 5.1, '5.00'),
        (zigzag, 3.4, '3.33'),
        (zigzag, float('nan'), '3.33'),
    ],
)
def test_widths_that_make_no_corridor(
    build: Callable[[float], Corridor], width: float, most: str
) -> None:
    with pytest.raises(ValueError, match=f'width must be from 0.05 to {most}, not {width}'):
        build(width)


def test_serpentine_turns_back_and_zigzag_does_not() -> None:
    for made, detour in ((serpentine(1.0), 3.0), (zigzag(1.0), 1.0)):
        steps = steps_from(made, made.start)[cell(made, made.goal)]
        straight = np.abs(np.subtract(made.goal, made.start)).sum() / made.resolution
        assert steps == pytest.approx(detour * straight, rel=0.2)
