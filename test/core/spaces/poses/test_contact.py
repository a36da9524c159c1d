"""Chords and single poses against an independent checker, and contacts at the boundary."""

from test.core.spaces.poses.robots import (
    checker,
    FOOTPRINTS,
    free_poses,
    MAPS,
    random_poses,
    random_twist,
)
from test.pose_checker import orbit

from hnr_planner.core import GridSpace, PoseSpace
import numpy as np
import pytest

N_POSES, N_CHORDS, N_ALONG = 300, 30, 150
SQUARE = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]


@pytest.fixture(scope='module', params=FOOTPRINTS)
def footprint(request):
    return FOOTPRINTS[request.param]


@pytest.fixture(scope='module', params=MAPS)
def space(request, footprint):
    return PoseSpace(MAPS[request.param](), footprint)


def test_a_pose_is_free_exactly_when_the_footprint_touches_no_blocked_cell(space, rng):
    poses = random_poses(space, rng, N_POSES)
    distances = checker(space).distances(poses)
    np.testing.assert_array_equal(space.contains(poses), distances > 1e-9)


def test_a_chord_is_free_all_along_and_ends_where_the_footprint_touches(space, rng):
    judge = checker(space)
    for pose in free_poses(space, rng, N_CHORDS):
        twist = random_twist(rng)
        lower, upper = space.chord(pose, twist)
        assert lower < 0.0 < upper
        fractions = np.concatenate([np.linspace(0.0, 1.0, N_ALONG)[1:-1], [1e-7, 1.0 - 1e-7]])
        along = orbit(pose, twist, lower + fractions * (upper - lower))
        assert (judge.distances(along) > 0.0).all(), (pose, twist)
        if abs(twist[2]) * (upper - lower) < 2.0 * np.pi * (1.0 - 1e-9):
            assert judge.distances(orbit(pose, twist, [lower, upper])) == pytest.approx(
                [0.0, 0.0], abs=1e-5
            )


def room(*occupied, size=(20, 20), **options):
    """Return the space of a square robot, two cells wide, in a room with occupied cells."""
    blocked = np.zeros(size, dtype=bool)
    for cell in occupied:
        blocked[cell] = True
    return PoseSpace(GridSpace.from_blocked(blocked), SQUARE, **options)


def test_a_footprint_that_touches_a_cell_or_the_edge_is_not_free():
    space = room((10, 12))
    beside = np.array([(11.0, 10.5, 0.0), (13.0 + 1.0, 10.5, 0.0), (1.0, 5.0, 0.0), (12, 9, 0)])
    assert not space.contains(beside).any()
    away = beside + [(-1e-6, 0, 0), (1e-6, 0, 0), (1e-6, 0, 0), (0, -1e-6, 0)]
    assert space.contains(away).all()


def test_a_pose_with_a_number_that_is_not_finite_is_not_free():
    space = room()
    for strange in (np.nan, np.inf, -np.inf, 1e300):
        poses = np.full((3, 3), 10.0) + np.diag(np.full(3, strange))
        free = space.contains(poses)
        assert not free[:2].any()
        assert free[2] == np.isfinite(strange)


def test_a_chord_from_the_middle_of_a_large_room_ends_where_one_from_near_the_wall_does():
    # From the middle the circle around the robot is followed first, through most of the room.
    space = room((150, 190), size=(300, 200))
    for twist in ((1.0, 0.0, 0.0), (1.0, 0.2, 0.004), (0.3, -1.0, -0.01)):
        middle = np.array((60.0, 150.0, 0.2))
        upper = space.chord(middle, twist).upper
        near = space.poses_along(middle, twist, [0.98 * upper])[0]
        assert space.chord(near, twist).upper == pytest.approx(0.02 * upper, abs=1e-9 * upper)


def test_a_robot_slides_along_a_wall_that_it_does_not_touch():
    space = room(*((0, k) for k in range(20)))
    assert space.chord((10.0, 2.0 + 1e-6, 0.0), (1.0, 0.0, 0.0)) == pytest.approx((-9.0, 9.0))
    assert tuple(space.chord((10.0, 2.0, 0.0), (1.0, 0.0, 0.0))) == (0.0, 0.0)


def test_a_side_stops_at_a_lone_cell_and_a_vertex_at_a_wall():
    lone = room((10, 15))
    assert lone.chord((5.0, 10.5, 0.0), (1.0, 0.0, 0.0)).upper == pytest.approx(9.0)
    turned = (5.0, 10.5, np.pi / 4)
    ahead = (np.sqrt(0.5), -np.sqrt(0.5), 0.0)  # along x in the map
    # The foremost vertex passes .3 below the cell, whose corner meets the side behind it.
    below = (5.0, 9.7, np.pi / 4)
    assert lone.chord(below, ahead).upper == pytest.approx(15.3 - 5.0 - np.sqrt(2.0))
    wall = room(*((k, 15) for k in range(20)))
    assert wall.chord(turned, ahead).upper == pytest.approx(15.0 - 5.0 - np.sqrt(2.0))


def test_nothing_squeezes_between_diagonal_cells():
    space = PoseSpace(
        GridSpace.from_blocked(np.eye(20, dtype=bool), 1.0),
        [(0.0, -1e-3), (1e-2, 0.0), (0.0, 1e-3)],
    )
    across = np.array((1.0, -1.0, 0.0)) / np.sqrt(2.0)
    upper = space.chord((9.0 - 2.0, 9.0 + 2.0, 0.0), across).upper
    assert upper <= 2.0 * np.sqrt(2.0)


def test_a_turn_in_place_that_meets_nothing_is_one_whole_turn():
    space = room((0, 0))
    for omega in (1.0, -0.5):
        half = np.pi / abs(omega)
        chord = space.chord((10.0, 10.0, 0.3), (0.0, 0.0, omega))
        assert chord == pytest.approx((-half, half))
        assert space.is_motion_valid((10.0, 10.0, 0.3), (0.0, 0.0, 50.0 * omega))


def test_a_turn_in_place_meets_a_corner_with_a_side_and_a_wall_with_a_vertex():
    # The corner (11, 11) is at 45 degrees, and above the robot's left side, which comes nearer.
    space = room((11, 11))
    turned, reach = np.pi / 8, np.hypot(0.8, 0.8)
    expected = np.pi / 4 + turned - np.arcsin(1.0 / reach)
    chord = space.chord((10.2, 10.2, -turned), (0.0, 0.0, 1.0))
    assert chord.upper == pytest.approx(expected)
    wall = room(*((k, 12) for k in range(20)))
    pose = (10.7, 10.0, 0.0)  # the vertex at 45 degrees reaches 1.3 to the right
    expected = np.pi / 4 - np.arccos(1.3 / np.sqrt(2.0))
    assert wall.chord(pose, (0.0, 0.0, -1.0)).upper == pytest.approx(expected)


@pytest.mark.parametrize('omega', [1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 1e-300])
def test_an_arc_of_any_radius_is_a_line_in_the_limit(omega):
    space = room((10, 15), (3, 4))
    pose, straight = (5.0, 10.2, 0.0), (1.0, 0.0, 0.0)
    expected = space.chord(pose, straight)
    for sign in (-1.0, 1.0):
        chord = space.chord(pose, (1.0, 0.0, sign * omega))
        assert chord == pytest.approx(expected, abs=200.0 * omega + 1e-9)
