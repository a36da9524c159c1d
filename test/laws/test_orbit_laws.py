"""
The laws of spaces of poses, whose lines are orbits of twists.

They are the laws of ``test_space_laws`` with a twist in the place of a direction and the orbit in
the place of the line. Yaws are equal up to whole turns.
"""

import copy
import pickle
from test.core.spaces.poses.robots import (
    FOOTPRINTS,
    free_poses,
    MAPS,
    random_poses,
    random_twist,
)
from test.pose_checker import orbit

from hnr_planner.core import (
    BallWalk,
    BoxSpace,
    DifferenceSpace,
    PoseSpace,
    ProductSpace,
    RequestError,
    sample,
    simplify,
    SpaceError,
    UnionSpace,
)
import numpy as np
import pytest

N = 40
CAR = {'drive': 'car', 'min_turning_radius': 1.0}


@pytest.fixture(
    scope='module',
    params=[
        ('speckle', 'rectangle', {}),
        ('lone cells and diagonals', 'L', CAR),
        ('surveyed', 'triangle', {'drive': 'omnidirectional'}),
    ],
    ids=lambda param: param[0],
)
def poses(request):
    name, footprint, options = request.param
    return PoseSpace(MAPS[name](), FOOTPRINTS[footprint], **options)


def lines(space, rng, n=N):
    """Return free poses with twists of any length."""
    return [(pose, random_twist(rng)) for pose in free_poses(space, rng, n)]


def tolerance(space, twist):
    """Return the time in which the robot moves by the margin of the contract."""
    lower, upper = space.bounds
    reach = np.hypot(*space.footprint.T).max()
    speed = np.hypot(*twist[:2]) + abs(twist[2]) * reach
    return 1e-9 * float(np.linalg.norm(upper - lower)) / speed


def is_whole_turn(chord, twist):
    return abs(twist[2]) * (chord.upper - chord.lower) > 2.0 * np.pi * (1.0 - 1e-9)


def test_bounds_hold_every_free_pose(poses, rng):
    lower, upper = poses.bounds
    assert lower.shape == upper.shape == (3,)
    free = free_poses(poses, rng, N)
    assert ((free > lower) & (free < upper)).all()
    assert not poses.contains(upper + (1.0, 1.0, 0.0))


def test_yaws_are_equal_up_to_whole_turns(poses, rng):
    some = random_poses(poses, rng, N)
    for turns in (-3, 1, 40):
        away = some + (0.0, 0.0, 2.0 * np.pi * turns)
        np.testing.assert_array_equal(poses.contains(away), poses.contains(some))
        back = poses.from_kernel(poses.to_kernel(away))
        assert ((-np.pi <= back[:, 2]) & (back[:, 2] < np.pi)).all()


def test_chord_is_open_around_a_pose_exactly_when_it_is_free(poses, rng):
    some = random_poses(poses, rng, 5 * N)
    free = poses.contains(some)
    assert free.any() and not free.all()
    for pose, is_free in zip(some, free, strict=True):
        chord = poses.chord(pose, random_twist(rng))
        assert (chord.lower < 0 < chord.upper) if is_free else tuple(chord) == (0.0, 0.0)


def test_poses_inside_a_chord_are_free_and_just_beyond_its_ends_are_not(poses, rng):
    for pose, twist in lines(poses, rng):
        chord = poses.chord(pose, twist)
        lower, upper = chord
        inside = lower + np.array([1e-5, 0.1, 0.5, 0.8, 1 - 1e-5]) * (upper - lower)
        assert poses.contains(orbit(pose, twist, inside)).all()
        if not is_whole_turn(chord, twist):
            beyond = tolerance(poses, twist)
            ends = orbit(pose, twist, [lower - beyond, upper + beyond])
            assert not poses.contains(ends).any()


def test_chord_is_the_same_from_everywhere_along_it(poses, rng):
    for pose, twist in lines(poses, rng):
        chord = poses.chord(pose, twist)
        if is_whole_turn(chord, twist):
            continue
        shift = chord.lower + rng.uniform(0.01, 0.99) * (chord.upper - chord.lower)
        (there,) = orbit(pose, twist, [shift])
        error = tolerance(poses, twist)
        assert np.add(poses.chord(there, twist), shift) == pytest.approx(chord, abs=error)


def test_turning_the_twist_round_swaps_the_ends(poses, rng):
    for pose, twist in lines(poses, rng):
        lower, upper = poses.chord(pose, twist)
        assert poses.chord(pose, -twist) == pytest.approx((-upper, -lower), rel=1e-12)


def test_a_chord_is_measured_in_times_of_its_twist(poses, rng):
    for pose, twist in lines(poses, rng):
        chord = np.array(poses.chord(pose, twist))
        for scale in (10.0 ** rng.uniform(-6, 6), 1e-150, 1e150):
            assert np.array(poses.chord(pose, scale * twist)) * scale == pytest.approx(
                chord, rel=1e-9
            )


def test_motion_is_valid_exactly_when_the_chord_reaches_its_end(poses, rng):
    verdicts = set()
    for pose in random_poses(poses, rng, 5 * N):
        twist = random_twist(rng)
        twist *= rng.uniform(0.0, 1.0) / np.linalg.norm(twist)
        valid = poses.is_motion_valid(pose, twist)
        assert valid == (poses.chord(pose, twist).upper > 1)
        (end,) = orbit(pose, twist, [1.0])
        assert poses.is_motion_valid(end, -twist) == valid
        assert poses.is_motion_valid(pose, np.zeros(3)) == poses.contains(pose)
        verdicts.add(valid)
    assert verdicts == {True, False}


def test_clearance_changes_by_no_more_than_the_robot_moves(poses, rng):
    reach = np.hypot(*poses.footprint.T).max()
    before = free_poses(poses, rng, N)
    for step in (1e-3, 0.05):
        moves = step * rng.uniform(-1.0, 1.0, before.shape)
        after = before + moves
        is_free = poses.contains(after)
        farthest = np.hypot(*moves.T[:2]) + reach * np.abs(moves[:, 2])
        change = np.abs(poses.clearance(after) - poses.clearance(before))
        assert (change <= farthest + 1e-9)[is_free].all()
    assert (poses.clearance(before) > 0.0).all()
    blocked = random_poses(poses, rng, N)
    blocked = blocked[~poses.contains(blocked)]
    assert (poses.clearance(blocked) == 0.0).all()


@pytest.mark.parametrize('bad', [np.nan, np.inf, -np.inf])
def test_numbers_that_are_not_finite_are_refused(poses, rng, bad):
    (good,) = free_poses(poses, rng, 1)
    for i in range(3):
        broken = good.copy()
        broken[i] = bad
        assert not poses.contains(broken)
        for call, args in (
            (poses.chord, (broken, np.ones(3))),
            (poses.chord, (good, broken)),
            (poses.is_motion_valid, (broken, good)),
            (poses.is_motion_valid, (good, broken)),
        ):
            with pytest.raises(ValueError, match=r'nan|inf'):
                call(*args)
    with pytest.raises(ValueError, match='twist must not be zero'):
        poses.chord(good, np.zeros(3))
    with pytest.raises(ValueError, match='twist must have shape'):
        poses.chord(good, (1.0, 0.0))


def test_a_pickled_space_and_a_copy_answer_alike(poses, rng):
    some = free_poses(poses, rng, 10)
    for other in (pickle.loads(pickle.dumps(poses)), copy.deepcopy(poses)):
        assert repr(other) == repr(poses)
        for pose in some:
            twist = random_twist(rng)
            assert other.chord(pose, twist) == poses.chord(pose, twist)


def test_a_pose_that_is_not_free_has_a_reason(poses, rng):
    some = random_poses(poses, rng, 3 * N)
    words = {poses.why_not_free(pose).split(' cell ')[0] for pose in some[~poses.contains(some)]}
    assert words & {'a pose at which the footprint touches the occupied'}
    assert words <= {
        'a pose at which the footprint touches the occupied',
        'a pose at which the footprint touches the unknown',
        'a pose at which the footprint reaches over the edge of the map',
    }


def test_what_needs_straight_lines_is_refused(poses, rng):
    (start,) = free_poses(poses, rng, 1)
    for walk in ('coordinate_hit_and_run', 'ball_walk', BallWalk(0.1)):
        with pytest.raises(RequestError, match=r'the walk \w+ needs a space with straight lines'):
            sample(poses, start, 1, walk=walk)
    with pytest.raises(RequestError, match='simplify needs a space with straight lines'):
        simplify(poses, [start, start])
    box = BoxSpace(*poses.bounds)
    for compose in (
        lambda: UnionSpace(box, poses),
        lambda: DifferenceSpace(box, poses),
        lambda: ProductSpace(poses, box),
    ):
        with pytest.raises(SpaceError, match='must have straight lines, got PoseSpace'):
            compose()
