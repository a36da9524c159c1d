"""The checker itself: it detects every collision that matters and passes what is legal."""

from fractions import Fraction
from test.brute_force import blocked_cells, chord_by_search, path_collisions

import numpy as np
from numpy.typing import NDArray
import pytest

FREE = np.zeros((10, 10), dtype=bool)


def with_blocked(*cells, shape=(10, 10)):
    """Return a map with some cells [row, column] blocked."""
    blocked = np.zeros(shape, dtype=bool)
    for row, col in cells:
        blocked[row, col] = True
    return blocked


def ends(lower, upper):
    return Fraction(lower), Fraction(upper)


def in_map_frame(points, resolution, origin):
    """Return points, given in cells, in the map frame; written with complex numbers."""
    points = np.asarray(points, dtype=float)
    z = (points[:, 0] + 1j * points[:, 1]) * resolution
    z = z * np.exp(1j * origin[2]) + origin[0] + 1j * origin[1]
    return np.stack([z.real, z.imag], axis=1)


WALL = with_blocked(*((row, 5) for row in range(10)))
RISING = with_blocked((4, 4), (5, 5))
FALLING = with_blocked((4, 5), (5, 4))

COLLISIONS: dict[str, tuple[NDArray, list]] = {
    'through a wall': (WALL, [(2, 2), (8, 3)]),
    'through a wall, from far between two points only': (WALL, [(0.1, 0.1), (9.9, 9.9)]),
    'into a wall': (WALL, [(2, 2), (5.5, 2)]),
    'starts in a wall': (WALL, [(5.5, 2), (2, 2)]),
    'a point in a wall': (WALL, [(5.5, 2.5)]),
    'a segment of length zero in a wall': (WALL, [(5.5, 2.5), (5.5, 2.5)]),
    'along the edge that two blocked cells share': (WALL, [(5.1, 3), (5.9, 3)]),
    'a point on the edge that two blocked cells share': (WALL, [(5.5, 3)]),
    'across a wall on the edge that two cells share': (WALL, [(4, 3), (7, 3)]),
    'a point where four blocked cells meet': (np.ones((10, 10), bool), [(5, 5)]),
    'across a level wall on the edge that two cells share': (WALL.T, [(3, 4), (3, 7)]),
    'on the outer edge, along a blocked cell': (WALL, [(4, 0), (7, 0)]),
    'on the outer edge of the last row': (WALL, [(4, 10), (7, 10)]),
    'cuts a corner': (with_blocked((4, 4)), [(3.5, 4.6), (4.6, 3.5)]),
    'cuts a corner by a millionth': (with_blocked((4, 4)), [(3, 5 + 1e-6), (5 + 1e-6, 3)]),
    'scrapes an edge by a millionth': (with_blocked((4, 4)), [(4 + 1e-6, 3), (4 + 1e-6, 6)]),
    'squeezes through a rising pair': (RISING, [(4.5, 5.5), (5.5, 4.5)]),
    'squeezes through a falling pair': (FALLING, [(4.5, 4.5), (5.5, 5.5)]),
    'squeezes at a slant': (RISING, [(4.9, 5.7), (5.1, 4.3)]),
    'squeezes almost along an edge': (RISING, [(4.9, 5 + 1e-9), (5.1, 5 - 1e-9)]),
    'squeezes upwards': (RISING, [(5, 5.5), (5, 4.5)]),
    'squeezes with a vertex at the corner': (RISING, [(4.5, 5.5), (5, 5), (5.5, 4.5)]),
    'squeezes in steps of a billionth': (
        RISING,
        [(4.5, 5.5), (5 - 1e-9, 5 + 1e-9), (5 + 2e-9, 5 - 1e-9), (5.5, 4.5)],
    ),
    'a segment from one of the diagonal pair to the other': (RISING, [(4.99, 4.99), (5.01, 5.01)]),
    'leaves on the left': (FREE, [(1, 1), (-0.001, 1)]),
    'leaves on the right': (FREE, [(1, 1), (10.001, 1)]),
    'leaves below': (FREE, [(1, 1), (1, -1e-6)]),
    'leaves above': (FREE, [(1, 1), (1, 10 + 1e-6)]),
    'passes outside around a wall': (WALL, [(4, 5), (4, -1), (7, -1), (7, 5)]),
    'is outside altogether': (FREE, [(-5, -5), (-6, -6)]),
    'is far away': (FREE, [(1, 1), (1e300, 1)]),
    'not a number': (FREE, [(1, 1), (np.nan, 1), (2, 2)]),
    'one point, not a number': (FREE, [(1, np.nan)]),
    'infinite': (FREE, [(1, 1), (1, np.inf)]),
    'the second segment only': (WALL, [(2, 2), (3, 3), (8, 3), (9, 3)]),
    'a map without a free cell': (np.ones((1, 1), bool), [(0.5, 0.5)]),
}

EXACT_COLLISIONS: dict[str, tuple[NDArray, list]] = {
    'squeezes exactly along an edge': (RISING, [(4.9, 5), (5.1, 5)]),
    'a point exactly in a squeeze': (FALLING, [(5, 5)]),
}

LEGAL: dict[str, tuple[NDArray, list]] = {
    'an empty map': (FREE, [(0.5, 0.5), (9.5, 0.7), (5, 9)]),
    'a single point': (WALL, [(1, 1)]),
    'a segment of length zero': (WALL, [(1, 1), (1, 1)]),
    'along a wall, a millionth away': (WALL, [(5 - 1e-6, 0.5), (5 - 1e-6, 9.5)]),
    'along a wall, within the tolerance': (WALL, [(5 + 5e-8, 0.5), (5 + 5e-8, 9.5)]),
    'along a wall, slanted': (WALL, [(5 - 1e-6, 0.5), (4, 9.5)]),
    'past a corner, a millionth away': (with_blocked((4, 4)), [(3, 5 - 3e-6), (5 - 3e-6, 3)]),
    'past a corner, touching it': (with_blocked((4, 4)), [(3, 5), (5, 3)]),
    'along the outer edge': (FREE, [(0, 0), (10, 0), (10, 10), (0, 10), (0, 0)]),
    'through a gap one cell wide': (
        with_blocked(*((row, 5) for row in range(10) if row != 4)), [(2, 4.5), (8, 4.5)]
    ),
    'diagonally through free cells, over a corner': (FREE, [(1, 1), (9, 9)]),
    'touching the inner corner of an L': (with_blocked((4, 4), (5, 5), (5, 4)), [(5, 5), (6, 4)]),
    'beside a squeeze, on one side of it': (RISING, [(4, 5 + 1e-6), (5 - 1e-6, 6)]),
    'past a diagonal pair': (RISING, [(3, 5), (5, 7)]),
    'into the corner of a diagonal pair and back': (
        FALLING, [(4.5, 4.5), (5 - 1e-6, 5 - 1e-6), (4.7, 4.5)]
    ),
}  # fmt: skip

FRAMES = {
    'cells': (1.0, (0.0, 0.0, 0.0)),
    'metres': (0.05, (-12.3, 4.56, 0.0)),
    'turned': (0.05, (-1.2, 3.4, 0.7)),
    'turned right round': (0.1, (3.0, -2.0, -2.5)),
}


@pytest.mark.parametrize('frame', FRAMES)
@pytest.mark.parametrize('case', COLLISIONS)
def test_a_collision_is_reported(case, frame):
    blocked, path = COLLISIONS[case]
    with np.errstate(invalid='ignore'):
        points = in_map_frame(path, *FRAMES[frame])
    assert path_collisions(points, blocked, *FRAMES[frame])


@pytest.mark.parametrize('case', EXACT_COLLISIONS)
def test_a_collision_within_rounding_is_reported_in_cells(case):
    blocked, path = EXACT_COLLISIONS[case]
    assert path_collisions(path, blocked, 1.0)


@pytest.mark.parametrize('frame', FRAMES)
@pytest.mark.parametrize('case', LEGAL)
def test_a_legal_path_is_passed(case, frame):
    blocked, path = LEGAL[case]
    assert path_collisions(in_map_frame(path, *FRAMES[frame]), blocked, *FRAMES[frame]) == []


@pytest.mark.parametrize('path', [np.empty((0, 2)), [1.0, 2.0], [[1.0, 2.0, 3.0]]])
def test_what_is_no_path_is_reported(path):
    assert path_collisions(path, FREE, 1.0)


def test_a_report_names_the_segment_and_the_cell():
    (line,) = path_collisions(
        [(0.1, 0.1), (0.4, 0.35), (0.8, 0.35)], with_blocked((3, 5)), 0.1, (0.0, 0.0, 0.0)
    )
    assert line == (
        'segment 1 from (0.4, 0.35) m to (0.8, 0.35) m enters the blocked cell at row 3, column 5'
    )


def test_every_segment_that_collides_is_reported():
    found = path_collisions([(2, 2), (8, 2.5), (2, 3.6), (2, 5)], WALL, 1.0)
    assert [line.split()[1] for line in found if 'enters' in line] == ['0', '1', '1']


def test_a_turned_map_is_turned_the_right_way():
    blocked = with_blocked((0, 8), shape=(10, 20))
    quarter = (0.0, 0.0, np.pi / 2)
    # With a yaw of a quarter turn the columns run along +y and the rows along -x.
    assert path_collisions([(-0.5, 8.5)], blocked, 1.0, quarter)
    assert path_collisions([(-0.5, 7.5)], blocked, 1.0, quarter) == []
    assert path_collisions([(0.5, 8.5)], blocked, 1.0, quarter)
    assert path_collisions([(-9.5, 19.5)], blocked, 1.0, quarter) == []


def test_inflation_is_a_disc_of_cell_centres():
    blocked = blocked_cells(with_blocked((5, 5)), 0.1, 0.2)
    disc = {(r, c) for r in range(10) for c in range(10) if (r - 5) ** 2 + (c - 5) ** 2 <= 4}
    assert {tuple(cell) for cell in np.argwhere(blocked).tolist()} == disc
    assert len(disc) == 13


def test_a_radius_that_rounding_leaves_just_short_still_counts():
    # .3 / .1 is 2.9999999999999996 in floats: the cell three away is blocked all the same.
    assert blocked_cells(with_blocked((5, 5)), 0.1, 0.3)[5, 8]
    assert not blocked_cells(with_blocked((5, 5)), 0.1, 0.299)[5, 8]


def test_radius_zero_blocks_the_occupied_cells_alone():
    assert np.array_equal(blocked_cells(WALL, 0.05, 0.0), WALL)


def test_inflation_reaches_over_the_whole_map_and_not_round_it():
    assert blocked_cells(with_blocked((0, 0)), 1.0, 100.0).all()
    corner = blocked_cells(with_blocked((0, 0)), 1.0, 1.0)
    assert np.argwhere(corner).tolist() == [[0, 0], [0, 1], [1, 0]]


def test_unknown_cells_block_and_are_not_inflated():
    unknown = with_blocked((8, 8))
    blocked = blocked_cells(with_blocked((2, 2)), 1.0, 1.0, unknown)
    assert blocked[8, 8] and blocked[2, 3]
    assert blocked.sum() == 6


def test_inflation_equals_every_cell_against_every_occupied_cell():
    rng = np.random.default_rng(1)
    for radius in (0.0, 0.05, 0.07, 0.1, 0.1118, 0.25, 1.0):
        occupied = rng.random((9, 13)) < 0.05
        expected = np.zeros_like(occupied)
        for r in range(9):
            for c in range(13):
                squared = [(r - i) ** 2 + (c - j) ** 2 for i, j in np.argwhere(occupied)]
                expected[r, c] = any(s <= (radius / 0.05) ** 2 + 1e-9 for s in squared)
        assert np.array_equal(blocked_cells(occupied, 0.05, radius), expected)


def test_the_checker_inflates_when_asked():
    path = [(3.5, 1.0), (3.5, 9.0)]
    assert path_collisions(path, WALL, 1.0) == []
    assert path_collisions(path, WALL, 1.0, robot_radius=2.0)


@pytest.mark.parametrize(
    ('point', 'direction', 'expected'),
    [
        ((2.5, 2.5), (1, 0), (-2.5, 2.5)),
        ((2.5, 2.5), (-2, 0), (-1.25, 1.25)),
        ((2.5, 2.5), (1, 1), (-2.5, 2.5)),
        ((4.5, 2.5), (0, 1), (-2.5, 7.5)),
        ((7, 1), (-1, 1), (-1, 1)),
        ((5, 2.5), (1, 0), (0, 0)),
        ((5.5, 2.5), (1, 0), (0, 0)),
        ((0, 2.5), (1, 0), (0, 0)),
        ((11, 2.5), (1, 0), (0, 0)),
    ],
)
def test_chord_beside_a_wall(point, direction, expected):
    assert chord_by_search(WALL, point, direction) == ends(*expected)


def test_chord_ends_where_it_touches_a_corner():
    assert chord_by_search(with_blocked((4, 4)), (4, 6), (1, -1)) == ends(-4, 1)
    assert chord_by_search(with_blocked((4, 4)), (4, 6 + 1e-12), (1, -1))[1] > 5


def test_chord_ends_where_it_runs_along_an_edge():
    assert chord_by_search(with_blocked((4, 4)), (5, 1), (0, 1)) == ends(-1, 3)
    assert chord_by_search(with_blocked((4, 4)), (5 + 1e-12, 1), (0, 1)) == ends(-1, 9)


def test_chord_does_not_squeeze():
    assert chord_by_search(RISING, (4, 6), (1, -1)) == ends(-4, 1)
    assert chord_by_search(RISING, (5, 5), (1, -1)) == ends(0, 0)


def test_chord_is_exact_where_floats_are_not():
    third = 1 / 3
    lower, upper = chord_by_search(WALL, (0.1, 0.5), (third, 0.0))
    assert upper == (5 - Fraction(0.1)) / Fraction(third)
    assert lower == -Fraction(0.1) / Fraction(third)


def test_chord_in_metres_is_the_chord_in_cells():
    assert chord_by_search(WALL, (1.25, 2.25), (1, 0), 0.5, (-1.0, 1.0)) == ends(-2.25, 0.25)


def test_a_direction_of_length_zero_is_refused():
    with pytest.raises(ValueError, match='length zero'):
        chord_by_search(FREE, (1, 1), (0, 0))


def test_checker_and_exact_chord_agree_on_random_segments():
    """2000 segments on random maps: free when, and only when, the chord reaches its end."""
    rng = np.random.default_rng(2)
    seen = {True: 0, False: 0}
    for _ in range(2000):
        blocked = rng.random((6, 8)) < rng.choice([0.05, 0.3])
        a, b = rng.uniform(0, [8, 6], (2, 2))
        if rng.random() < 0.3:
            # Lines over lattice points, where ties are.
            b = np.clip(np.round(a) + 2 * (np.round(a) - a), 0, [8, 6])
        if np.array_equal(a, b) or chord_by_search(blocked, a, b - a) == ends(0, 0):
            continue
        upper = chord_by_search(blocked, a, b - a)[1]
        margin = float(upper - 1) * np.linalg.norm(b - a)
        if abs(margin) < 1e-5:
            continue
        free = path_collisions([a, b], blocked, 1.0) == []
        # What touches a corner alone is a collision for the open set, and within the tolerance.
        if free != (margin > 0):
            end = a + float(upper) * (b - a)
            assert free and np.abs(end - np.round(end)).max() < 1e-6
            continue
        seen[free] += 1
    assert min(seen.values()) > 300
