"""
The walks obey their law, and walks that are wrong in known ways are caught.

Right walks have 32 p-values here, each compared with ALPHA: were the seeds drawn anew, one run in
a million would fail. They are fixed.
"""

from test.laws import maps
from test.sampling_gate import (
    one_step,
    Region,
    t1_uniform_on_the_square,
    t2_stationarity,
    t3_reversibility,
    t5_ends,
    unit,
)

from hnr_planner.core import GridSpace, sample
from hnr_planner.core.sampling.walks import coordinate_hit_and_run_step, hit_and_run_step
from hnr_planner.core.streams import stream
import numba
import numpy as np
import pytest
from scipy import stats

ALPHA = 1e-6 / 32
N_ONE_STEP = 1_000_000
N_STATIONARITY = 100_000
N_REVERSIBILITY = 200_000

U_SHAPE, TWO_ROOMS = Region(maps.U_SHAPE), Region(maps.TWO_ROOMS)
REGIONS = pytest.mark.parametrize('region', [U_SHAPE, TWO_ROOMS], ids=['u shape', 'two rooms'])
ONE_STEP = pytest.mark.parametrize(
    ('region', 'point', 'seed'),
    [
        (U_SHAPE, (0.7, 8.3), 1),
        (U_SHAPE, (3.2, 1.1), 2),
        (TWO_ROOMS, (4.6, 3.3), 3),
        (TWO_ROOMS, (8.9, 5.2), 4),
    ],
    ids=['in an arm', 'between the arms', 'beside the door', 'in a room'],
)


# -- the walks of the package ---------------------------------------------------------------------


@numba.njit
def _hit_and_run(data, points, rng, moved):
    for k in range(len(points)):
        hit_and_run_step(data, points[k], rng, moved[k])


@numba.njit
def _coordinate_hit_and_run(data, points, rng, moved):
    for k in range(len(points)):
        coordinate_hit_and_run_step(data, points[k], rng, moved[k])


WALKS = pytest.mark.parametrize(
    'walk', [_hit_and_run, _coordinate_hit_and_run], ids=['hit_and_run', 'coordinate_hit_and_run']
)


def step_of(walk, region):
    """Return one step of the package's walk on a region."""
    space = GridSpace.from_blocked(region.occupied)

    def step(points, rng):
        at = space.to_kernel(points)
        moved = np.empty_like(at)
        walk(space.data, at, stream(int(rng.integers(2**63))), moved)
        return space.from_kernel(moved)

    return step


@ONE_STEP
def test_one_step_of_hit_and_run(region, point, seed):
    """T1 and T5: uniform over directions and over the chord, up to its very ends."""
    step = step_of(_hit_and_run, region)
    direction, position = one_step(region, step, point, N_ONE_STEP, seed)
    assert t1_uniform_on_the_square(direction, position) > ALPHA
    assert t5_ends(position) > ALPHA


@ONE_STEP
def test_one_step_of_coordinate_hit_and_run(region, point, seed):
    """Either axis as often as the other, and uniform on the chord."""
    step = step_of(_coordinate_hit_and_run, region)
    direction, position = one_step(region, step, point, N_STATIONARITY, seed)
    upright = np.abs(direction - 0.5) < 1e-9
    assert (upright | (direction < 1e-9) | (direction > 1 - 1e-9)).all()
    counts, _, _ = np.histogram2d(upright, position, bins=(2, 32), range=[(0, 1), (0, 1)])
    assert counts.sum() == N_STATIONARITY
    assert stats.chisquare(counts.ravel()).pvalue > ALPHA
    assert t5_ends(position) > ALPHA


@WALKS
@REGIONS
def test_a_walk_keeps_the_uniform_law(region, walk):
    """T2."""
    assert t2_stationarity(region, step_of(walk, region), N_STATIONARITY, seed=5) > ALPHA


@WALKS
@REGIONS
def test_a_walk_is_reversible(region, walk):
    """T3."""
    assert t3_reversibility(region, step_of(walk, region), N_REVERSIBILITY, seed=6) > ALPHA


@pytest.mark.parametrize('walk', ['hit_and_run', 'coordinate_hit_and_run'])
@pytest.mark.parametrize(
    ('region', 'corner'), [(U_SHAPE, (8, 0)), (TWO_ROOMS, (0, 0))], ids=['u shape', 'two rooms']
)
def test_draws_are_uniform_in_the_end(region, corner, walk):
    """From a corner of a turned map: the last points of 5000 chains of 300 steps."""
    resolution, x, y, yaw = 0.05, 3.0, -2.0, 0.7
    space = GridSpace.from_blocked(region.occupied, resolution, (x, y, yaw))
    start = space.cell_centres([corner[0]], [corner[1]])[0]
    draws = sample(space, start, 1, walk=walk, n_chains=5000, burn_in=299, seed=7)[:, 0]
    assert space.contains(draws).all()
    z = (draws[:, 0] - x + 1j * (draws[:, 1] - y)) * np.exp(-1j * yaw) / resolution
    cells = region.cell_of(np.stack([z.real, z.imag], axis=1))
    assert stats.chisquare(np.bincount(cells, minlength=region.n_cells)).pvalue > ALPHA


# -- walks that are wrong, and a right one --------------------------------------------------------


def right(region, points, rng):
    return on_chord(region, points, any_direction(points, rng), rng.random(len(points)))


def forward_ray_only(region, points, rng):
    directions = any_direction(points, rng)
    _, upper = region.chords(points, directions)
    return points + (upper * rng.random(len(points)))[:, None] * directions


def direction_from_a_box(region, points, rng):
    return on_chord(region, points, rng.uniform(-1, 1, points.shape), rng.random(len(points)))


def directions_in_whole_degrees(region, points, rng):
    directions = unit(np.radians(rng.integers(360, size=len(points))))
    return on_chord(region, points, directions, rng.random(len(points)))


def all_pieces_of_the_line(region, points, rng):
    directions = any_direction(points, rng)
    reach = np.hypot(*region.occupied.shape)
    moved, todo = points.copy(), np.arange(len(points))
    while len(todo):
        moved[todo] = points[todo] + rng.uniform(-reach, reach, (len(todo), 1)) * directions[todo]
        inside = ((moved[todo] > 0) & (moved[todo] < region.occupied.shape[::-1])).all(axis=1)
        column, row = np.floor(moved[todo[inside]]).astype(int).T
        inside[inside] = region.cell_index[row, column] >= 0
        todo = todo[~inside]
    return moved


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


def any_direction(points, rng):
    return unit(rng.uniform(0, 2 * np.pi, len(points)))


def on_chord(region, points, directions, fractions):
    lower, upper = region.chords(points, directions)
    return points + (lower + fractions * (upper - lower))[:, None] * directions


def p_values(walk, region, point):
    """Return the p-value of every test of the gate."""

    def step(points, rng):
        return walk(region, points, rng)

    direction, position = one_step(region, step, point, N_ONE_STEP, seed=8)
    return {
        'T1': t1_uniform_on_the_square(direction, position),
        'T2': t2_stationarity(region, step, N_STATIONARITY, seed=9),
        'T3': t3_reversibility(region, step, N_REVERSIBILITY, seed=10),
        'T5': t5_ends(position),
    }


@pytest.mark.parametrize(
    ('walk', 'caught_by'),
    [
        (right, ()),
        (forward_ray_only, ('T1', 'T2', 'T3')),
        (direction_from_a_box, ('T1',)),
        (directions_in_whole_degrees, ('T1',)),
        (all_pieces_of_the_line, ('T1',)),
        (beta_on_the_chord, ('T1', 'T2')),
        (ends_cut, ('T5',)),
        (never_quite_to_the_far_end, ('T5',)),
        (both_axes_in_turn, ('T3',)),
    ],
    ids=lambda value: getattr(value, '__name__', ''),
)
def test_the_gate_catches_what_is_wrong_and_passes_what_is_right(walk, caught_by):
    found = p_values(walk, U_SHAPE, (0.7, 8.3))
    assert all(found[test] < ALPHA for test in caught_by), found
    assert caught_by or min(found.values()) > ALPHA, found
