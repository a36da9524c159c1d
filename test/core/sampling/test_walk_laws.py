"""
The walks of the package obey their law, on sets that are not convex, in 2, 3 and 10 dimensions.

Every p-value is compared with ALPHA; the seeds are fixed.
"""

from test.core.sampling.chain_steps import step_of
from test.core.sampling.gate_sets import FURTHER, GateSet, marked, SETS
from test.sampling_gate import (
    ALPHA,
    ball_step,
    N_LAW,
    N_ONE_STEP,
    one_step,
    same_ball_step,
    same_law,
    t1_uniform_on_the_square,
    t2_stationarity,
    t3_reversibility,
    t5_ends,
)

from hnr_planner.core import BallWalk, GridSpace, sample, WALKS
import numpy as np
import pytest
from scipy import stats

N_COORDINATE = 100_000
N_CHAINS, N_STEPS = 2_000, 200

#: Sets in which all belongs to the sweeps: other files hold walks in spaces that are no grids.
ALL_BUT_GRIDS = (*FURTHER, 'box without balls, 10-D')

EACH_WALK = pytest.mark.parametrize('walk', WALKS)


#: One step from each point of each set.
EACH_STEP = pytest.mark.parametrize(
    ('name', 'k'),
    [
        marked(name, k, further=ALL_BUT_GRIDS)
        for name, gate_set in SETS.items()
        for k in range(len(gate_set().points))
    ],
)


@pytest.fixture(params=[marked(name, further=ALL_BUT_GRIDS) for name in SETS])
def gate_set(request) -> GateSet:
    return SETS[request.param]()


@EACH_STEP
def test_one_step_of_hit_and_run(name, k):
    """T1 and T5: uniform over directions and over the chord, up to its very ends."""
    region, space, points = SETS[name]()
    step = step_of('hit_and_run', space)
    directions, position = one_step(region, step, points[k], N_ONE_STEP, seed=k)
    assert t1_uniform_on_the_square(directions, position) > ALPHA
    assert t5_ends(position) > ALPHA


@EACH_STEP
def test_one_step_of_coordinate_hit_and_run(name, k):
    """Any axis as often as any other, and uniform on the chord."""
    region, space, points = SETS[name]()
    step = step_of('coordinate_hit_and_run', space)
    directions, position = one_step(region, step, points[k], N_COORDINATE, seed=k)
    axis = directions.argmax(axis=1)
    assert (np.abs(directions).sum(axis=1) == 1.0).all()
    assert ((position > 0) & (position < 1)).all()
    counts, _, _ = np.histogram2d(axis, position, bins=(np.arange(region.dim + 1), 32))
    assert stats.chisquare(counts.ravel()).pvalue > ALPHA
    assert t5_ends(position) > ALPHA


@pytest.mark.parametrize('segment_visible', [False, True], ids=['end point', 'segment'])
def test_the_ball_walk_is_the_one_of_its_definition(gate_set, segment_visible):
    """
    One step in direction and length, stays included; then T2 and T3.

    The ball is so large that it reaches past walls: which version it is, shows.
    """
    region, space, points = gate_set
    radius = 0.7 * (region.upper - region.lower).min()
    step = step_of(BallWalk(radius, segment_visible=segment_visible), space)
    right = ball_step(region, radius, segment_visible=segment_visible)
    for k, point in enumerate(points):
        assert same_ball_step(step, right, point, radius, N_LAW, seed=k) > ALPHA
    assert t2_stationarity(region, step, N_LAW, seed=5) > ALPHA
    assert t3_reversibility(region, step, N_LAW, seed=6) > ALPHA


@EACH_WALK
def test_a_walk_keeps_the_uniform_law(gate_set, walk):
    """T2."""
    step = step_of(walk, gate_set.space)
    assert t2_stationarity(gate_set.region, step, N_LAW, seed=5) > ALPHA


@EACH_WALK
def test_a_walk_is_reversible(gate_set, walk):
    """T3."""
    step = step_of(walk, gate_set.space)
    assert t3_reversibility(gate_set.region, step, N_LAW, seed=6) > ALPHA


@pytest.mark.parametrize('walk', ['hit_and_run', 'coordinate_hit_and_run'])
def test_draws_are_uniform_in_the_end(gate_set, walk):
    """The last points of many chains from one point."""
    region, space, points = gate_set
    rng = np.random.default_rng(7)
    draws = step_of(walk, space, N_STEPS)(np.tile(points[0], (N_CHAINS, 1)), rng)
    assert space.contains(draws).all()
    others = region.uniform(N_LAW, np.random.default_rng(8))
    assert same_law(region.cell_of(draws), region.cell_of(others)) > ALPHA


@pytest.mark.parametrize('name', ['u shape', 'two rooms'])
def test_draws_are_uniform_on_a_turned_map(name):
    """The same of ``sample``, in metres, in the frame of the map."""
    region, _, points = SETS[name]()
    resolution, x, y, yaw = 0.05, 3.0, -2.0, 0.7
    turned = GridSpace.from_blocked(region.occupied, resolution, (x, y, yaw))
    turn = np.exp(1j * yaw) * resolution
    start = (points[0] @ [1, 1j]) * turn + complex(x, y)
    steps = N_STEPS - 1  # before the one draw, which is a step as well
    ends = sample(turned, (start.real, start.imag), 1, n_chains=N_CHAINS, burn_in=steps, seed=7)
    draws = ends[:, 0]
    assert turned.contains(draws).all()
    z = (draws @ [1, 1j] - complex(x, y)) / turn
    cells = region.cell_of(np.stack([z.real, z.imag], axis=1))
    others = region.cell_of(region.uniform(N_LAW, np.random.default_rng(8)))
    assert same_law(cells, others) > ALPHA
