"""What a grid makes of a map: which cells are blocked, where it lies, what it refuses."""

from test.brute_force import blocked_cells
from test.laws import maps

from hnr_planner.core import GridSpace, HnrError, SpaceError
import numpy as np
import pytest

# -- which cells are blocked ---------------------------------------------------------------------

VALUES = np.array([[-1, 0, 1, 64, 65, 66, 99, 100, 101, 127, -128]], dtype=np.int8)


@pytest.mark.parametrize(
    ('arguments', 'blocked'),
    [
        ({}, [1, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1]),
        ({'unknown': 'free'}, [0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0]),
        ({'occupied_threshold': 100}, [1, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1]),
        ({'occupied_threshold': 1}, [1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1]),
    ],
)
def test_thresholds_and_unknown_cells(arguments, blocked):
    space = GridSpace.from_occupancy(VALUES, 0.1, **arguments)
    np.testing.assert_array_equal(space.blocked[0], np.array(blocked, dtype=bool))


def test_only_occupied_cells_count_as_walls():
    space = GridSpace.from_occupancy(VALUES, 0.1)
    expected = (VALUES >= 65) & (VALUES <= 100)
    np.testing.assert_array_equal(space.occupied, expected)


@pytest.mark.parametrize('resolution', [0.05, 0.1, 1.0])
@pytest.mark.parametrize('cells', [0.0, 0.99, 1.0, 1.41, 1.415, 2.0, 2.24, 4.4, 7.0, 12.3])
def test_inflation_is_the_disc_of_the_definition(resolution: float, cells: float):
    occupied = maps.speckle(50, 40, 0.01, seed=6)
    radius = cells * resolution
    space = GridSpace.from_blocked(occupied, resolution, robot_radius=radius)
    np.testing.assert_array_equal(space.blocked, blocked_cells(occupied, resolution, radius))
    np.testing.assert_array_equal(space.occupied, occupied)


def test_a_radius_of_whole_cells_reaches_the_cell_at_that_distance():
    """0.3 / 0.1 is a little less than 3: the limit must not depend on such rounding."""
    occupied = np.zeros((1, 9), dtype=bool)
    occupied[0, 4] = True
    space = GridSpace.from_blocked(occupied, 0.1, robot_radius=0.3)
    np.testing.assert_array_equal(np.flatnonzero(~space.blocked[0]), [0, 8])


@pytest.mark.parametrize('resolution', [0.05, 0.025, 0.1, 0.03, 0.0254, 0.5])
def test_lengths_of_single_precision_are_the_decimals_that_they_stand_for(resolution: float):
    """A message carries .05 as .05000000074505806, which would cost a ring of inflation."""
    occupied = maps.speckle(40, 40, 0.02, seed=8)
    single = float(np.float32(resolution))
    for cells in range(1, 13):
        radius = round(cells * resolution, 6)
        expected = GridSpace.from_blocked(occupied, resolution, robot_radius=radius)
        for side, length in ((single, radius), (single, np.float32(radius))):
            space = GridSpace.from_blocked(occupied, side, robot_radius=float(length))
            assert space.frame == expected.frame
            assert space.robot_radius == expected.robot_radius == radius
            np.testing.assert_array_equal(space.blocked, expected.blocked)


@pytest.mark.parametrize('resolution', [1 / 3, 0.123456789, 2.0**-12, 1.0, 1e-30, 1e30])
def test_lengths_of_double_precision_are_left_alone(resolution: float):
    assert GridSpace.from_blocked([[False]], resolution).resolution == resolution


def test_unknown_cells_and_the_edge_of_the_map_are_not_inflated():
    data = np.zeros((9, 9), dtype=np.int8)
    data[4, 4] = -1
    space = GridSpace.from_occupancy(data, 0.1, robot_radius=0.5)
    assert space.blocked.sum() == 1


def test_a_large_radius_over_a_large_map_is_exact_too():
    occupied = np.zeros((900, 900), dtype=bool)
    occupied[450, 450] = True
    space = GridSpace.from_blocked(occupied, robot_radius=401.0)
    row, column = np.indices(occupied.shape) - 450
    np.testing.assert_array_equal(space.blocked, row**2 + column**2 <= 401**2)


def test_the_map_is_not_changed_and_not_shared():
    data = np.zeros((4, 4), dtype=np.int8)
    space = GridSpace.from_occupancy(data, 0.1)
    data[:] = 100
    assert not space.blocked.any()
    np.testing.assert_array_equal(data, 100)


def test_lists_and_other_integers_are_maps_too():
    space = GridSpace.from_occupancy([[0, 100], [255, 0]], 1.0)
    np.testing.assert_array_equal(space.blocked, [[False, True], [True, False]])


def test_a_cell_costs_at_most_twelve_bytes():
    space = GridSpace.from_blocked(maps.speckle(1000, 1000, 0.1, seed=1))
    arrays = [space.data.free_distance, space.walls, space.data.labels]
    assert sum(array.nbytes for array in arrays) <= 12 * 1000 * 1000


# -- where it lies -------------------------------------------------------------------------------


@pytest.mark.parametrize('yaw', [0.0, 0.3, np.pi / 2, -2.5])
def test_cells_lie_where_the_pose_of_the_origin_puts_them(yaw: float):
    occupied = maps.TWO_ROOMS
    space = GridSpace.from_blocked(occupied, 0.2, (3.0, -1.0, yaw))
    turn = np.array([(np.cos(yaw), -np.sin(yaw)), (np.sin(yaw), np.cos(yaw))])
    for row, column in np.ndindex(*occupied.shape):
        centre = turn @ [(column + 0.5) * 0.2, (row + 0.5) * 0.2] + (3.0, -1.0)
        np.testing.assert_allclose(space.cell_centres(row, column), centre, atol=1e-12)
        assert space.contains(centre) == (not occupied[row, column])


def test_bounds_hold_the_turned_map():
    space = GridSpace.from_blocked(np.zeros((10, 20), bool), 0.5, (1.0, 2.0, np.pi / 2))
    lower, upper = space.bounds
    np.testing.assert_allclose(lower, (-4.0, 2.0), atol=1e-9)
    np.testing.assert_allclose(upper, (1.0, 12.0), atol=1e-9)
    assert space.shape == (10, 20)
    assert space.resolution == 0.5
    assert space.origin == (1.0, 2.0, np.pi / 2)


def test_maps_in_national_grids_work():
    """Coordinates of 5,000 km are rounded to 2e-8 of a cell of .05 m: enough."""
    space = GridSpace.from_blocked(maps.TWO_ROOMS, 0.05, (5e5, 5e6, 0.1))
    free = np.argwhere(~maps.TWO_ROOMS)
    assert space.contains(space.cell_centres(*free.T)).all()


# -- nearest reachable point ---------------------------------------------------------------------


@pytest.mark.parametrize('seed', range(5))
def test_the_nearest_reachable_point(seed: int):
    occupied = maps.speckle(30, 30, 0.45, seed)
    space = GridSpace.from_blocked(occupied, 0.1, (1.0, 2.0, 0.5))
    component = space.largest_component()
    start = space.cell_centres(*np.argwhere(component)[0])
    dense = np.linspace(0.05, 0.95, 10)
    rng = np.random.default_rng(seed)
    for _ in range(20):
        goal = space.cell_centres(*rng.uniform(-5, 35, 2))
        cells = np.argwhere(component)
        inside = [
            space.cell_centres(*(cells + (y - 0.5, x - 0.5)).T) for x in dense for y in dense
        ]
        least = min(np.hypot(*(points - goal).T).min() for points in inside)
        nearest = space.nearest_reachable(start, goal, 10.0)
        offset = np.hypot(*(nearest - goal))
        assert space.contains(nearest) and space.connected(start, nearest)
        assert least - 0.1 * 0.05 * np.sqrt(2) - 1e-6 <= offset <= least + 1e-6
        assert space.nearest_reachable(start, goal, offset * 0.99 - 1e-9) is None


def test_a_goal_that_is_reachable_is_its_own_nearest_point():
    space = GridSpace.from_blocked(maps.TWO_ROOMS)
    np.testing.assert_allclose(space.nearest_reachable((0.5, 3.5), (9.3, 3.2), 0.0), (9.3, 3.2))


def test_without_a_limit_the_nearest_point_is_found_however_far():
    space = GridSpace.from_blocked(maps.TWO_ROOMS)
    nearest = space.nearest_reachable((0.5, 3.5), (1e6, 3.5), np.inf)
    np.testing.assert_allclose(nearest, (11.0, 3.5), atol=1e-6)


def test_nothing_is_reachable_from_a_start_that_is_not_free():
    space = GridSpace.from_blocked(maps.TWO_ROOMS)
    assert space.nearest_reachable((-1.0, 0.0), (9.5, 3.5), 100.0) is None


def test_without_free_cells_the_largest_component_is_empty():
    assert not GridSpace.from_blocked(np.ones((3, 4), bool)).largest_component().any()


# -- what it refuses -----------------------------------------------------------------------------

FREE = np.zeros((2, 3), dtype=np.int8)


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ((np.zeros((0, 3), np.int8), 0.1), r'shape \(0, 3\)'),
        ((np.zeros(6, np.int8), 0.1), r'shape \(6,\)'),
        ((np.zeros((2, 3)), 0.1), 'float64'),
        ((FREE, 0.0), 'resolution must be above 0 and finite, got 0.0'),
        ((FREE, -0.05), 'resolution .* got -0.05'),
        ((FREE, np.nan), 'resolution .* got nan'),
        ((FREE, np.inf), 'resolution .* got inf'),
        ((FREE, 0.1, (np.nan, 0.0, 0.0)), 'origin must be three finite numbers'),
        ((FREE, 0.1, (0.0, 0.0, np.inf)), 'origin must be three finite numbers'),
        ((FREE, 0.1, (0.0, 0.0)), 'origin must be three finite numbers'),
        ((FREE, 0.05, (1e9, 0.0, 0.0)), 'too far away'),
        (([[0, 1], [0]], 0.1), 'rows of the same length'),
        ((FREE, 0.1, '123'), "origin must be three finite numbers .* got '123'"),
        ((FREE, 'fine'), "resolution must be a number, got 'fine'"),
        ((FREE, 0.1, 'here'), "origin must be three finite numbers .* got 'here'"),
    ],
)
def test_a_map_that_is_none_is_refused(arguments, words: str):
    with pytest.raises(SpaceError, match=words) as caught:
        GridSpace.from_occupancy(*arguments)
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, HnrError)


@pytest.mark.parametrize('blocked', [[[0, 50]], [[0.0, np.nan]], [['wall', '']], [[-1, 0]]])
def test_cells_that_are_neither_true_nor_false_are_refused(blocked):
    with pytest.raises(SpaceError, match='true or false'):
        GridSpace.from_blocked(blocked)


def test_a_radius_beyond_all_cells_blocks_them_all_and_is_named():
    space = GridSpace.from_blocked(maps.TWO_ROOMS, robot_radius=1e308)
    assert space.blocked.all()
    assert 'robot radius' in space.why_not_free((0.5, 0.5))


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        ({'robot_radius': -0.1}, 'robot_radius must be at least 0 and finite, got -0.1'),
        ({'robot_radius': np.nan}, 'robot_radius .* got nan'),
        ({'robot_radius': None}, 'robot_radius must be a number, got None'),
        ({'occupied_threshold': 65.5}, 'occupied_threshold must be a whole number, got 65.5'),
        ({'occupied_threshold': 0}, r'occupied_threshold must be in 1..100, got 0'),
        ({'occupied_threshold': 101}, r'occupied_threshold must be in 1..100, got 101'),
        ({'unknown': 'maybe'}, "'blocked' or 'free', got 'maybe'"),
    ],
)
def test_a_setting_out_of_range_is_refused(arguments, words: str):
    with pytest.raises(SpaceError, match=words):
        GridSpace.from_occupancy(FREE, 0.1, **arguments)
