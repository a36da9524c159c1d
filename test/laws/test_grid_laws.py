"""What holds on a grid beyond the laws of every space: cells, corners, chords, components."""

from test.brute_force import blocked_cells, chord_by_search, path_collisions
from test.laws import maps
from test.laws.grids import EXACT_FRAMES, FRAMES, GRIDS, in_map_frame
from test.sweeps import sweep_but

from hnr_planner.core import GridSpace
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy import ndimage

EXACT = settings(max_examples=300, deadline=None, derandomize=True, database=None)


def touching_cells_are_free(blocked, x, y):
    """Return whether every cell that a point touches is free, by the definition."""
    rows, cols = blocked.shape
    return all(
        0 <= row < rows and 0 <= col < cols and not blocked[row, col]
        for row in range(int(np.ceil(y)) - 1, int(np.floor(y)) + 1)
        for col in range(int(np.ceil(x)) - 1, int(np.floor(x)) + 1)
    )


# -- the boundary ---------------------------------------------------------------------------------


@pytest.mark.parametrize('frame', EXACT_FRAMES)
@pytest.mark.parametrize('grid', GRIDS)
def test_a_point_is_free_when_every_cell_that_it_touches_is(grid, frame):
    """Corners, edges and centres of all cells, and of a ring of cells outside the map."""
    blocked = GRIDS[grid]
    space = GridSpace.from_blocked(blocked, *EXACT_FRAMES[frame])
    rows, cols = blocked.shape
    x, y = np.meshgrid(np.arange(-1, cols + 1.5, 0.5), np.arange(-1, rows + 1.5, 0.5))
    cells = np.stack([x.ravel(), y.ravel()], axis=1)
    expected = [touching_cells_are_free(blocked, *cell) for cell in cells]
    points = in_map_frame(cells, *EXACT_FRAMES[frame])
    assert space.contains(points).tolist() == expected
    for point, is_free in zip(points, expected, strict=True):
        chord = space.chord(point, (1.0, 2.0))
        assert (chord.lower < 0 < chord.upper) == is_free
        assert is_free or tuple(chord) == (0.0, 0.0)
        assert space.is_motion_valid(point, point) == is_free


@pytest.mark.parametrize('frame', FRAMES)
def test_a_point_that_rounds_onto_an_edge_has_one_answer(frame):
    """However it rounds, alone or among many, all queries of a point agree."""
    space = GridSpace.from_blocked(maps.TWO_ROOMS, *FRAMES[frame])
    rows, cols = maps.TWO_ROOMS.shape
    x, y = np.meshgrid(np.arange(0, cols + 0.1, 0.25), np.arange(0, rows + 0.1, 0.25))
    points = in_map_frame(np.stack([x.ravel(), y.ravel()], axis=1), *FRAMES[frame])
    together = space.contains(points)
    assert 0 < together.sum() < len(points)
    for point, is_free in zip(points, together, strict=True):
        assert space.contains(point) == is_free
        assert (space.chord(point, (0.3, -0.4)).upper > 0) == is_free
        assert space.is_motion_valid(point, point) == is_free
        assert space.connected(point, point) == is_free


@pytest.mark.parametrize('frame', FRAMES)
@pytest.mark.parametrize('mirrored', [False, True])
def test_nothing_squeezes_between_diagonal_obstacles(frame, mirrored):
    """In a checkerboard no two cells are joined, in whatever frame rounding happens."""
    blocked = maps.CHECKERBOARD[:, ::-1] if mirrored else maps.CHECKERBOARD
    space = GridSpace.from_blocked(blocked, *FRAMES[frame])
    centres = np.argwhere(~blocked)[:, ::-1] + 0.5
    points = in_map_frame(centres, *FRAMES[frame])
    for i, start in enumerate(points):
        for j, end in enumerate(points):
            assert space.is_motion_valid(start, end) == (i == j)
            assert space.connected(start, end) == (i == j)
        for direction in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
            turned = in_map_frame(np.array(direction, float), 1.0, (0, 0, FRAMES[frame][1][2]))
            upper = space.chord(start, turned).upper
            assert upper == pytest.approx(0.5 * FRAMES[frame][0], rel=1e-9)


def test_a_ray_along_a_grid_line_needs_both_sides_free():
    blocked = maps.drawn('......', '..#...', '......', '......')
    space = GridSpace.from_blocked(blocked)
    assert space.chord((0.5, 2.0), (1, 0)) == (-0.5, 1.5)
    assert space.chord((0.5, 3.0), (1, 0)) == (-0.5, 1.5)
    assert space.chord((0.5, 1.0), (1, 0)) == (-0.5, 5.5)
    assert space.chord((2.0, 0.5), (0, 1)) == (-0.5, 1.5)
    assert space.chord((3.0, 0.5), (0, 1)) == (-0.5, 1.5)
    assert space.chord((4.0, 0.5), (0, 1)) == (-0.5, 3.5)


def test_a_chord_ends_at_a_corner_that_it_touches():
    blocked = maps.drawn('......', '..#...', '......', '......')
    space = GridSpace.from_blocked(blocked)
    assert space.chord((1.0, 1.0), (1, 1)).upper == 1
    assert space.chord((1.0, 3.0), (1, -1)).upper == 1
    assert space.chord((1.0, 1.0), (1, -1)) == (-1, 1)
    assert space.chord((0.5, 1.5), (3, 1)).upper == 0.5
    assert space.chord((0.5, 1.5), (3, 2)).upper == 0.5
    assert not space.is_motion_valid((1.0, 3.0), (3.0, 1.0))


# -- the chord against exact fractions ------------------------------------------------------------


@st.composite
def grids(draw):
    rows, cols = draw(st.integers(1, 8)), draw(st.integers(1, 8))
    cells = st.lists(st.booleans(), min_size=rows * cols, max_size=rows * cols)
    if draw(st.booleans()):
        return np.array(draw(cells)).reshape(rows, cols)
    return maps.speckle(rows, cols, 0.15, draw(st.integers(0, 10**6)))


def coordinates(denominator):
    """Multiples of a power of two: halves hit corners and edges, finer ones pass between them."""
    return st.integers(-denominator, 9 * denominator).map(lambda n: n / denominator)


POINTS = st.one_of(*(st.tuples(coordinates(d), coordinates(d)) for d in (2, 4, 1024)))
DIRECTIONS = st.one_of(
    st.tuples(st.integers(-3, 3), st.integers(-3, 3)),
    st.tuples(coordinates(1024), coordinates(1024)),
    st.tuples(st.integers(-1024, 1024), st.integers(-3, 3)),
).filter(any)


@EXACT
@given(grids(), POINTS, DIRECTIONS)
def test_chord_is_the_exact_one(blocked, point, direction):
    """
    Equal to the chord in fractions, ties included.

    Coordinates are multiples of 1/1024, so a line that misses a corner misses it by more than any
    rounding, and one that hits it hits it in floats too.
    """
    lower, upper = chord_by_search(blocked, point, direction)
    found = GridSpace.from_blocked(blocked).chord(point, direction)
    assert (found.lower, found.upper) == pytest.approx((float(lower), float(upper)), rel=1e-15)


@EXACT
@given(grids(), POINTS, DIRECTIONS, st.sampled_from([0.125, 0.5, 4.0]), POINTS)
def test_chord_in_metres_is_the_exact_one(blocked, cell, direction, resolution, origin):
    space = GridSpace.from_blocked(blocked, resolution, (*origin, 0.0))
    point = np.array(origin) + np.array(cell) * resolution
    lower, upper = chord_by_search(blocked, point, direction, resolution, origin)
    found = space.chord(point, direction)
    assert (found.lower, found.upper) == pytest.approx((float(lower), float(upper)), rel=1e-15)


@EXACT
@given(grids(), POINTS, POINTS)
def test_motion_is_valid_exactly_when_no_closed_cell_touches_it(blocked, start, end):
    space = GridSpace.from_blocked(blocked)
    if start == end:
        expected = touching_cells_are_free(blocked, *start)
    else:
        expected = chord_by_search(blocked, start, np.subtract(end, start))[1] > 1
    assert space.is_motion_valid(start, end) == expected
    assert space.is_motion_valid(end, start) == expected
    if expected:
        assert path_collisions([start, end], blocked, 1.0) == []


@pytest.mark.parametrize('frame', sweep_but(['cells', 'turned'], FRAMES))
def test_chord_is_the_exact_one_for_any_floats(frame):
    """1000 random lines on random maps; a line this near to a corner by chance: p < 1e-6."""
    rng = np.random.default_rng(7)
    resolution, origin = FRAMES[frame]
    for _ in range(50):
        blocked = maps.speckle(8, 7, rng.choice([0.05, 0.2, 0.4]), seed=int(rng.integers(10**6)))
        space = GridSpace.from_blocked(blocked, resolution, origin)
        for cell, angle in zip(rng.uniform(0, 7, (20, 2)), rng.uniform(0, 7, 20), strict=True):
            direction = np.array([np.cos(angle), np.sin(angle)])
            expected = [resolution * float(s) for s in chord_by_search(blocked, cell, direction)]
            found = space.chord(
                in_map_frame(cell, resolution, origin),
                in_map_frame(direction, 1.0, (0.0, 0.0, origin[2])),
            )
            assert found == pytest.approx(expected, abs=1e-9 * resolution)


# -- from cells to space --------------------------------------------------------------------------


@pytest.mark.parametrize('unknown', ['blocked', 'free'])
@pytest.mark.parametrize('threshold', [1, 65, 100])
def test_every_value_of_an_occupancy_grid_has_its_meaning(unknown, threshold):
    """All 256 values: occupied from the threshold to 100, unknown outside 0..100, else free."""
    data = np.arange(-128, 128).astype(np.int8).reshape(16, 16)
    occupied = (data >= threshold) & (data <= 100)
    is_unknown = (data < 0) | (data > 100)
    blocking = is_unknown if unknown == 'blocked' else None
    for radius in (0.0, 1.0, 2.3):
        space = GridSpace.from_occupancy(
            data, 1.0, robot_radius=radius, occupied_threshold=threshold, unknown=unknown
        )
        assert np.array_equal(space.occupied, occupied)
        assert np.array_equal(space.blocked, blocked_cells(occupied, 1.0, radius, blocking))


# -- components -----------------------------------------------------------------------------------


@pytest.mark.parametrize('frame', ['metres', 'turned'])
@pytest.mark.parametrize('grid', ['two rooms', 'checkerboard', 'spiral', 'speckle', 'u shape'])
def test_connected_is_what_a_flood_fill_finds(grid, frame):
    blocked = GRIDS[grid]
    space = GridSpace.from_blocked(blocked, *FRAMES[frame])
    labels, _ = ndimage.label(~blocked)
    rng = np.random.default_rng(8)
    cells = rng.uniform(0, blocked.shape[::-1], (60, 2))
    label = labels[cells[:, 1].astype(int), cells[:, 0].astype(int)]
    points = in_map_frame(cells, *FRAMES[frame])
    for a, label_a in zip(points, label, strict=True):
        for b, label_b in zip(points, label, strict=True):
            assert space.connected(a, b) == (label_a == label_b != 0)


@pytest.mark.parametrize('grid', GRIDS)
def test_the_largest_component_is_the_one_of_the_flood_fill(grid):
    labels, n = ndimage.label(~GRIDS[grid])
    largest = GridSpace.from_blocked(GRIDS[grid]).largest_component()
    assert largest.shape == labels.shape
    if n == 0:
        assert not largest.any()
        return
    assert len(np.unique(labels[largest])) == 1
    assert np.array_equal(largest, labels == labels[largest][0])
    assert largest.sum() == np.bincount(labels[labels > 0]).max()
