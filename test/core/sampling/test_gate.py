"""The gate catches walks that are wrong in known ways, and passes the right one."""

from test.core.sampling.gate_sets import hall_and_dome, marked, SETS, u_shape
from test.sampling_gate import (
    ALPHA,
    ball_step,
    N_LAW,
    N_ONE_STEP,
    one_step,
    same_ball_step,
    t1_uniform_on_the_square,
    t2_stationarity,
    t3_reversibility,
    t5_ends,
)
from test.sweeps import sweep

import numpy as np
import pytest

BALL = 5.0


def right(region, points, rng):
    return on_chord(region, points, any_direction(points, rng), rng.random(len(points)))


def forward_ray_only(region, points, rng):
    directions = any_direction(points, rng)
    _, upper = region.chords(points, directions)
    return points + (upper * rng.random(len(points)))[:, None] * directions


def direction_from_a_box(region, points, rng):
    return on_chord(region, points, rng.uniform(-1, 1, points.shape), rng.random(len(points)))


def directions_in_whole_degrees(region, points, rng):
    angles = np.radians(rng.integers(360, size=len(points)))
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    return on_chord(region, points, directions, rng.random(len(points)))


def all_pieces_of_the_line(region, points, rng):
    directions = any_direction(points, rng)
    ends = ((region.lower - points) / directions, (region.upper - points) / directions)
    lower, upper = np.minimum(*ends).max(axis=1), np.maximum(*ends).min(axis=1)
    moved, todo = points.copy(), np.arange(len(points))
    while len(todo):
        s = rng.uniform(lower[todo], upper[todo])
        moved[todo] = points[todo] + s[:, None] * directions[todo]
        todo = todo[region.depth(moved[todo]) <= 0]
    return moved


def chord_of_one_piece(region, points, rng):
    directions = any_direction(points, rng)
    first, last = region.pieces(points, directions)
    here = ((first < 0) & (last > 0)).argmax(axis=1)
    lower, upper = (np.take_along_axis(ends, here[:, None], 1) for ends in (first, last))
    return points + (lower + rng.random((len(points), 1)) * (upper - lower)) * directions


def beta_on_the_chord(region, points, rng):
    fractions = rng.beta(1.1, 1.1, len(points))
    return on_chord(region, points, any_direction(points, rng), fractions)


def ends_cut(region, points, rng):
    fractions = rng.uniform(1e-4, 1 - 1e-4, len(points))
    return on_chord(region, points, any_direction(points, rng), fractions)


def never_quite_to_the_far_end(region, points, rng):
    directions = any_direction(points, rng)
    lower, upper = region.chords(points, directions)
    fractions = rng.random(len(points))
    return points + (lower + fractions * (0.998 * upper - lower))[:, None] * directions


def both_axes_in_turn(region, points, rng):
    for axis in np.eye(2):
        directions = np.tile(axis, (len(points), 1))
        points = on_chord(region, points, directions, rng.random(len(points)))
    return points


def ball_of_uniform_radius(region, points, rng):
    """Take the textbook's ball walk, but with too many short steps."""
    moved = points + BALL * rng.random((len(points), 1)) * any_direction(points, rng)
    return np.where(region.depth(moved)[:, None] > 0, moved, points)


def ball_until_free(region, points, rng):
    """Draw again instead of staying."""
    moved, todo = points.copy(), np.arange(len(points))
    step = ball_step(region, BALL, segment_visible=False)
    while len(todo):
        moved[todo] = step(points[todo], rng)
        todo = todo[(moved[todo] == points[todo]).all(axis=1)]
    return moved


def ball_through_walls(region, points, rng):
    """Look at the end point where the segment counts."""
    return ball_step(region, BALL, segment_visible=False)(points, rng)


def any_direction(points, rng):
    directions = rng.normal(size=points.shape)
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def on_chord(region, points, directions, fractions):
    lower, upper = region.chords(points, directions)
    return points + (lower + fractions * (upper - lower))[:, None] * directions


def step_of(walk, region):
    return lambda points, rng: walk(region, points, rng)


def of_one_step(walk, gate_set):
    """Return the p-values of the tests of one step."""
    region, _, points = gate_set
    directions, position = one_step(region, step_of(walk, region), points[0], N_ONE_STEP, seed=8)
    return {
        'T1': t1_uniform_on_the_square(directions, position),
        'T5': t5_ends(position),
    }


def of_the_law(walk, region):
    """Return the p-values of the tests of what a walk keeps."""
    step = step_of(walk, region)
    return {
        'T2': t2_stationarity(region, step, N_LAW, seed=9),
        'T3': t3_reversibility(region, step, N_LAW, seed=10),
    }


@pytest.mark.parametrize('name', [*map(marked, SETS)])
def test_the_right_walk_passes(name):
    gate_set = SETS[name]()
    found = of_one_step(right, gate_set) | of_the_law(right, gate_set.region)
    assert min(found.values()) > ALPHA, found


@pytest.mark.parametrize(
    ('walk', 'caught_by'),
    [
        (forward_ray_only, ('T1', 'T2', 'T3')),
        sweep(direction_from_a_box, ('T1',)),
        sweep(directions_in_whole_degrees, ('T1',)),
        (all_pieces_of_the_line, ('T1',)),
        (beta_on_the_chord, ('T1',)),
        (ends_cut, ('T5',)),
        (never_quite_to_the_far_end, ('T5',)),
        (both_axes_in_turn, ('T3',)),
    ],
)
def test_what_is_wrong_in_the_plane_is_caught(walk, caught_by):
    gate_set = u_shape()
    found = of_one_step(walk, gate_set) | of_the_law(walk, gate_set.region)
    assert all(found[test] < ALPHA for test in caught_by), found


@pytest.mark.parametrize('name', [*map(marked, ['stone, 3-D', 'box without balls, 10-D'])])
@pytest.mark.parametrize(
    ('walk', 'test'),
    [
        (forward_ray_only, 'T1'),
        sweep(direction_from_a_box, 'T1'),
        sweep(all_pieces_of_the_line, 'T1'),
        sweep(beta_on_the_chord, 'T1'),
        (ends_cut, 'T5'),
        sweep(never_quite_to_the_far_end, 'T5'),
    ],
)
def test_what_is_wrong_in_space_is_caught(name, walk, test):
    assert of_one_step(walk, SETS[name]())[test] < ALPHA


@pytest.mark.parametrize('walk', [sweep(all_pieces_of_the_line), chord_of_one_piece])
def test_what_is_wrong_about_pieces_is_caught(walk):
    assert of_one_step(walk, hall_and_dome())['T1'] < ALPHA


@pytest.mark.parametrize('walk', [direction_from_a_box, all_pieces_of_the_line])
def test_the_law_alone_certifies_nothing(walk):
    """These walks are wrong, and keep the uniform law forth and back."""
    assert min(of_the_law(walk, hall_and_dome().region).values()) > ALPHA


@pytest.mark.parametrize(
    ('walk', 'segment_visible'),
    [(ball_of_uniform_radius, False), (ball_until_free, False), (ball_through_walls, True)],
)
def test_what_is_wrong_in_a_ball_is_caught(walk, segment_visible):
    """Only drawing again breaks the uniform law: the others are found by their single steps."""
    region, _, points = u_shape()
    step, right = step_of(walk, region), ball_step(region, BALL, segment_visible=segment_visible)
    assert same_ball_step(step, right, points[0], BALL, N_LAW, seed=11) < ALPHA
    assert same_ball_step(right, right, points[0], BALL, N_LAW, seed=12) > ALPHA
    kept = t2_stationarity(region, step, N_LAW, seed=13) > ALPHA
    assert kept == (walk is not ball_until_free)
