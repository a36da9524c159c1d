"""
The laws of a space, stated once and held on every space.

Points and directions are drawn at random: lines that touch a corner exactly have probability
zero here, and tests of their own where a space has corners.
"""

import copy
import pickle

import numpy as np
import pytest

N = 200
BAD_NUMBERS = (np.nan, np.inf, -np.inf)


def size(space):
    """Return the diagonal of the bounds: the scale of every tolerance."""
    lower, upper = space.bounds
    return float(np.linalg.norm(upper - lower))


def rounding(space):
    """Return the spacing of floating-point numbers at the far end of the space."""
    return float(np.spacing(np.abs(space.bounds).max()))


def tolerance(space):
    """Return the distance to the boundary from which points are judged: the contract's margin."""
    return max(1e-9 * size(space), 8.0 * rounding(space))


def random_points(space, rng, n=N):
    """Return points of the bounds grown by a tenth on every side, so that some lie outside."""
    lower, upper = space.bounds
    rim = 0.1 * (upper - lower)
    return rng.uniform(lower - rim, upper + rim, (n, space.dim))


def free_points(space, rng, n=N):
    """Return points drawn until so many of them are free: at least a fortieth of all has to be."""
    found = []
    for _ in range(40):
        points = random_points(space, rng, n + 25)
        found.extend(points[space.contains(points)])
        if len(found) >= n:
            return np.array(found[:n])
    raise AssertionError(f'of {40 * (n + 25)} points {len(found)} are free')


def random_lines(space, rng, n=N):
    """Return free points with directions of any length."""
    directions = rng.standard_normal((n, space.dim)) * 10.0 ** rng.uniform(-3, 3, (n, 1))
    return zip(free_points(space, rng, n), directions, strict=True)


def test_bounds_hold_every_free_point(space, rng):
    lower, upper = space.bounds
    assert lower.shape == upper.shape == (space.dim,)
    assert (lower < upper).all()
    points = random_points(space, rng, 20 * N)
    inside = ((points > lower) & (points < upper)).all(axis=1)
    assert not inside.all()
    assert not space.contains(points[~inside]).any()


def test_chord_is_open_around_a_point_exactly_when_it_is_free(space, rng):
    points = random_points(space, rng)
    free = space.contains(points)
    assert free.any() and not free.all()
    for point, is_free in zip(points, free, strict=True):
        chord = space.chord(point, rng.standard_normal(space.dim))
        if is_free:
            assert chord.lower < 0 < chord.upper
            assert np.isfinite(chord).all()
        else:
            assert tuple(chord) == (0.0, 0.0)


def test_points_inside_a_chord_are_free(space, rng):
    for point, direction in random_lines(space, rng):
        lower, upper = space.chord(point, direction)
        fractions = np.concatenate([[1e-6, 1 - 1e-6], rng.random(10)])
        inside = point + (lower + fractions * (upper - lower))[:, None] * direction
        assert space.contains(inside).all()


def test_points_just_beyond_the_ends_of_a_chord_are_not_free(space, rng):
    for point, direction in random_lines(space, rng):
        lower, upper = space.chord(point, direction)
        beyond = tolerance(space) / np.linalg.norm(direction)
        assert not space.contains(point + (upper + beyond) * direction)
        assert not space.contains(point + (lower - beyond) * direction)


def test_chord_is_the_same_from_everywhere_along_it(space, rng):
    for point, direction in random_lines(space, rng):
        lower, upper = space.chord(point, direction)
        shift = lower + rng.uniform(0.01, 0.99) * (upper - lower)
        moved = space.chord(point + shift * direction, direction)
        error = tolerance(space) / np.linalg.norm(direction)
        assert moved.lower + shift == pytest.approx(lower, abs=error)
        assert moved.upper + shift == pytest.approx(upper, abs=error)


def test_turning_the_direction_round_swaps_the_ends(space, rng):
    for point, direction in random_lines(space, rng):
        lower, upper = space.chord(point, direction)
        assert space.chord(point, -direction) == pytest.approx((-upper, -lower), rel=1e-12)


def test_a_chord_is_measured_in_lengths_of_its_direction(space, rng):
    for point, direction in random_lines(space, rng):
        lower, upper = space.chord(point, direction)
        scale = 10.0 ** rng.uniform(-6, 6)
        scaled = space.chord(point, scale * direction)
        assert scaled.lower * scale == pytest.approx(lower, rel=1e-9)
        assert scaled.upper * scale == pytest.approx(upper, rel=1e-9)


def test_a_direction_may_have_any_length(space, rng):
    point = free_points(space, rng, 1)[0]
    unit = np.eye(space.dim)[0]
    upper = space.chord(point, unit).upper
    assert space.chord(point, 1e-150 * unit).upper * 1e-150 == pytest.approx(upper)
    assert space.chord(point, 1e150 * unit).upper * 1e150 == pytest.approx(upper)


def test_a_direction_of_length_zero_is_refused(space, rng):
    for point in random_points(space, rng, 5):
        with pytest.raises(ValueError, match='zero'):
            space.chord(point, np.zeros(space.dim))


@pytest.mark.parametrize('bad', BAD_NUMBERS)
def test_numbers_that_are_not_finite_are_refused(space, rng, bad):
    good = free_points(space, rng, 1)[0]
    for i in range(space.dim):
        broken = good.copy()
        broken[i] = bad
        for call, args in (
            (space.chord, (broken, np.ones(space.dim))),
            (space.chord, (good, broken)),
            (space.is_motion_valid, (broken, good)),
            (space.is_motion_valid, (good, broken)),
        ):
            with pytest.raises(ValueError, match=r'nan|inf'):
                call(*args)


@pytest.mark.parametrize('extra', [-1, 1])
def test_points_of_another_dimension_are_refused(space, rng, extra):
    good, wrong = free_points(space, rng, 1)[0], np.full(space.dim + extra, 0.5)
    for call, args in (
        (space.contains, (wrong,)),
        (space.contains, (wrong[None],)),
        (space.chord, (wrong, good)),
        (space.chord, (good, wrong)),
        (space.chord, (good[None], good)),
        (space.is_motion_valid, (wrong, good)),
        (space.is_motion_valid, (good, wrong)),
    ):
        with pytest.raises(ValueError):
            call(*args)


def test_motion_is_valid_exactly_when_the_chord_reaches_its_end(space, rng):
    starts, ends = random_points(space, rng), random_points(space, rng)
    # Half of them short, or nearly every motion of a narrow space would be blocked.
    ends[::2] = starts[::2] + 0.1 * (ends[::2] - starts[::2])
    verdicts = set()
    for start, end in zip(starts, ends, strict=True):
        valid = space.is_motion_valid(start, end)
        assert valid == (space.chord(start, end - start).upper > 1)
        verdicts.add(valid)
    assert verdicts == {True, False}


def test_motion_is_valid_in_both_directions_or_neither(space, rng):
    starts, ends = random_points(space, rng), random_points(space, rng)
    ends[::2] = starts[::2] + 0.1 * (ends[::2] - starts[::2])
    for start, end in zip(starts, ends, strict=True):
        assert space.is_motion_valid(start, end) == space.is_motion_valid(end, start)


def test_motion_stops_short_of_the_end_of_a_chord_and_not_beyond(space, rng):
    for point, direction in random_lines(space, rng):
        step = tolerance(space) / np.linalg.norm(direction)
        upper = space.chord(point, direction).upper
        if upper <= step:
            continue
        assert space.is_motion_valid(point, point + (upper - step) * direction)
        assert not space.is_motion_valid(point, point + (upper + step) * direction)


def test_motion_to_the_same_point_is_valid_exactly_when_it_is_free(space, rng):
    points = random_points(space, rng)
    for point, is_free in zip(points, space.contains(points), strict=True):
        assert space.is_motion_valid(point, point) == is_free


def test_contains_takes_one_point_or_many(space, rng):
    points = random_points(space, rng)
    many = space.contains(points)
    assert many.shape == (len(points),)
    assert many.dtype == bool
    one_by_one = [space.contains(point) for point in points]
    assert {type(answer) for answer in one_by_one} <= {bool, np.bool_}
    assert one_by_one == many.tolist()
    assert space.contains(np.empty((0, space.dim))).shape == (0,)


def test_a_point_that_is_not_finite_is_never_free(space, rng):
    good = free_points(space, rng, 1)[0]
    for bad in BAD_NUMBERS:
        points = np.tile(good, (space.dim, 1))
        np.fill_diagonal(points, bad)
        try:
            answers = space.contains(points)
        except ValueError:
            continue
        assert not answers.any()


def test_inputs_are_not_changed_and_may_be_anything_like_an_array(space, rng):
    points = free_points(space, rng, 3)
    points.flags.writeable = False
    before = points.copy()
    direction = np.ones(space.dim)
    direction.flags.writeable = False
    answers = [
        (
            space.contains(kind(points)).tolist(),
            space.chord(kind(points[0]), kind(direction)),
            space.is_motion_valid(kind(points[0]), kind(points[1])),
        )
        for kind in (np.asarray, np.ndarray.tolist, np.asfortranarray, lambda p: (p * 1.0)[..., :])
    ]
    assert all(answer == answers[0] for answer in answers)
    assert np.array_equal(points, before)


def test_what_is_returned_is_fresh(space, rng):
    lower, _ = space.bounds
    kept = lower.copy()
    try:
        lower[:] = np.nan
    except ValueError:
        pass  # read-only is as good
    assert np.array_equal(space.bounds[0], kept)


def test_a_pickled_space_and_a_copy_answer_alike(space, rng):
    points, directions = random_points(space, rng, 40), rng.standard_normal((40, space.dim))
    for other in (pickle.loads(pickle.dumps(space)), copy.deepcopy(space)):
        assert repr(other) == repr(space)
        np.testing.assert_array_equal(other.bounds, space.bounds)
        np.testing.assert_array_equal(other.contains(points), space.contains(points))
        for x, u in zip(points, directions, strict=True):
            assert other.chord(x, u) == space.chord(x, u)


def test_connected_is_an_equivalence_that_no_motion_leaves(space, rng):
    if not hasattr(space, 'connected'):
        pytest.skip('this space cannot distinguish its components')
    points = free_points(space, rng, 25)
    related = np.array([[space.connected(a, b) for b in points] for a in points])
    assert related.diagonal().all()
    assert np.array_equal(related, related.T)
    # Transitive: who is related to a friend of a friend is related at once.
    assert np.array_equal(related @ related, related)
    seen = np.array([[space.is_motion_valid(a, b) for b in points] for a in points])
    assert related[seen].all()


def test_no_point_that_is_not_free_is_connected(space, rng):
    if not hasattr(space, 'connected'):
        pytest.skip('this space cannot distinguish its components')
    free = free_points(space, rng, 1)[0]
    points = random_points(space, rng)
    for point in points[~space.contains(points)]:
        assert not space.connected(point, free)
        assert not space.connected(free, point)


def test_clearance_changes_by_no_more_than_the_distance_moved(space, rng):
    if not hasattr(space, 'clearance'):
        pytest.skip('this space measures no clearance')
    points = free_points(space, rng)
    moved = points + 0.1 * size(space) * rng.standard_normal(points.shape)
    before, after = space.clearance(points), space.clearance(moved)
    assert before.shape == after.shape == (len(points),)
    assert (before >= 0).all() and (after >= 0).all()
    way = np.linalg.norm(moved - points, axis=1) + 1e-9 * size(space)
    # Without obstacles both are infinite.
    assert ((before <= after + way) & (after <= before + way)).all()
