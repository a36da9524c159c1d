"""Total variation and relaxation time, against laws and walks that are known."""

import math

from hnr_planner.core import relaxation_time, RequestError, total_variation
import numpy as np
import pytest

N_CELLS, N, REPETITIONS = 100, 4000, 400


def distances(law, shares, measure=total_variation):
    """Return plug-in, floor and lower bound (REPETITIONS, 3) for N draws of a law."""
    rng = np.random.default_rng(1)
    draws = rng.choice(len(law), size=(REPETITIONS, N), p=law)
    return np.array([measure(cells, shares) for cells in draws])


def twisted(by):
    """Return the uniform law, and one at the total variation ``by`` from it."""
    uniform = np.full(N_CELLS, 1 / N_CELLS)
    law = uniform + 2 * by / N_CELLS * np.where(np.arange(N_CELLS) % 2, 1, -1)
    return uniform, law


def test_draws_of_the_law_itself_lie_at_the_floor():
    """400 repetitions: the mean to .002 (4 of its standard errors), the deviation to a sixth."""
    uniform, _ = twisted(0.0)
    plug_in, floor, lower_bound = distances(uniform, uniform).T
    assert floor == pytest.approx(math.sqrt((N_CELLS - 1) / (2 * math.pi * N)))
    assert plug_in.mean() == pytest.approx(floor[0], abs=0.002)
    assert plug_in.std() == pytest.approx(0.30 / math.sqrt(N), rel=0.15)
    assert lower_bound.mean() == pytest.approx(0.0, abs=0.005)


def test_the_floor_holds_for_unequal_cells():
    shares = np.arange(1.0, 21.0) / 210.0
    plug_in, floor, _ = distances(shares, shares).T
    assert plug_in.mean() == pytest.approx(floor[0], rel=0.03)


def test_the_bounds_enclose_the_distance():
    """Means over 400 repetitions, to .002; a million draws, to .005."""
    for distance in (0.05, 0.25):
        uniform, law = twisted(distance)
        plug_in, _, lower_bound = distances(law, uniform).mean(axis=0)
        assert 0.3 * distance < lower_bound < distance + 0.002 < plug_in + 0.004
        many = np.random.default_rng(2).choice(N_CELLS, size=1_000_000, p=law)
        assert total_variation(many, uniform)[::2] == pytest.approx((distance,) * 2, abs=0.005)


def test_a_bound_from_the_draws_that_chose_the_cells_is_caught():
    """The mutant takes one half twice, and is above the distance on average."""

    def one_half_twice(cells, shares):
        observed = np.bincount(cells[::2], minlength=len(shares)) / len(cells[::2])
        return 0.0, 0.0, (observed - shares)[observed > shares].sum()

    uniform, law = twisted(0.05)
    assert distances(law, uniform, one_half_twice)[:, 2].mean() > 0.05 + 0.01


def test_all_draws_in_one_cell_are_as_far_as_can_be():
    shares = [0.25, 0.75]
    assert total_variation([0] * 10, shares)[::2] == (0.75, 0.75)


@pytest.mark.parametrize(
    ('cells', 'shares', 'words'),
    [
        ([0.5, 1.0], [0.5, 0.5], 'cells must be whole numbers in 1 dimension, got float64'),
        ([[0, 1]], [0.5, 0.5], r'got int64 \(1, 2\)'),
        ([0, 2], [0.5, 0.5], 'numbers below 2, got 2 up to 2'),
        ([0, -1], [0.5, 0.5], 'cells must be at least 0, got -1'),
        ([0], [0.5, 0.5], '2 or more numbers below 2, got 1'),
        ([0, 1], [0.5, 0.6], r'shares must be probabilities .* sum 1.1'),
        ([0, 1], [1.5, -0.5], 'shares must be probabilities'),
        ([0, 1], [np.nan, 1.0], 'shares must be probabilities'),
    ],
)
def test_malformed_cells_are_refused(cells, shares, words):
    with pytest.raises(RequestError, match=words):
        total_variation(cells, shares)


# -- relaxation time


def walk(matrix, n_chains, n_draws, seed):
    """Return states (n_chains, n_draws) of chains by a transition matrix, from its own law."""
    rng = np.random.default_rng(seed)
    values, vectors = np.linalg.eig(np.transpose(matrix))
    law = np.real(vectors[:, np.argmax(np.real(values))])
    reach = np.cumsum(matrix, axis=1)
    states = np.empty((n_chains, n_draws), dtype=int)
    states[:, 0] = rng.choice(len(matrix), size=n_chains, p=law / law.sum())
    for k in range(1, n_draws):
        draw = rng.random(n_chains)[:, None]
        states[:, k] = (draw > reach[states[:, k - 1]]).sum(axis=1)
    return states


@pytest.mark.parametrize('lag', [1, 5, 20])
@pytest.mark.parametrize(('leave', 'come_back'), [(0.02, 0.02), (0.01, 0.09)])
def test_two_states_relax_as_known(leave, come_back, lag):
    """1 / (leave + come back), to a twentieth: a million moves, 7 standard deviations."""
    matrix = [[1 - leave, leave], [come_back, 1 - come_back]]
    states = walk(matrix, 1000, 1000, seed=2)
    known = 1 / (leave + come_back)
    assert relaxation_time(states, lag) == pytest.approx(known, rel=0.05)


def test_coarse_cells_never_lengthen_it_and_a_lag_brings_it_back():
    """A corridor of six rooms, seen as two halves: far too short, until moves take longer."""
    matrix = np.zeros((6, 6))
    for a, b in zip(range(5), range(1, 6), strict=True):
        matrix[a, b] = matrix[b, a] = 0.25
    matrix += np.diag(1 - matrix.sum(axis=1))
    known = 1 / (1 - np.sort(np.linalg.eigvalsh(matrix))[-2])
    states = walk(matrix, 1000, 1000, seed=3)
    assert relaxation_time(states) == pytest.approx(known, rel=0.05)
    halves = states // 3
    assert relaxation_time(halves) < 0.7 * known
    assert relaxation_time(halves) < relaxation_time(halves, lag=20) < 1.02 * known
    assert relaxation_time(halves, lag=20) > 0.8 * known


def test_independent_draws_relax_at_once():
    states = np.random.default_rng(4).integers(4, size=(10, 10_000))
    assert relaxation_time(states) == pytest.approx(1.0, abs=0.05)
    assert relaxation_time(states, lag=3) >= 1.0


@pytest.mark.parametrize(
    'states',
    [np.zeros((3, 10), int), [[0, 1] * 5, [2, 3] * 5], [[5] * 10, [7] * 10]],
    ids=['one cell', 'two rooms', 'stuck in two places'],
)
def test_chains_that_never_meet_never_relax(states):
    assert relaxation_time(states) == math.inf


@pytest.mark.parametrize(
    ('cells', 'lag', 'words'),
    [
        ([0, 1, 0], 1, 'cells must be whole numbers in 2 dimensions'),
        ([[0, 1]], 2, r'cells must have chains longer than lag 2, got \(1, 2\)'),
        ([[0, 1]], 0, 'lag must be at least 1, got 0'),
        (np.zeros((0, 5), int), 1, 'longer than lag 1'),
        ([[0, -1]], 1, 'cells must be at least 0, got -1'),
    ],
)
def test_malformed_moves_are_refused(cells, lag, words):
    with pytest.raises(RequestError, match=words):
        relaxation_time(cells, lag)
