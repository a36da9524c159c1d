"""The verdict of diagnose: stuck and confined chains never pass, and chains that mix do."""

from test.core.sampling.diagnostics.chains import autoregressive
from test.laws import maps

from hnr_planner.core import diagnose, GridSpace, RequestError, sample
import numpy as np
import pytest

DRAWS = autoregressive(0.5, 4, 4000, 3, seed=0)


def test_chains_that_mix_converge():
    found = diagnose(DRAWS)
    assert found.converged
    assert found.message.startswith('converged: R-hat at most 1.00')
    assert found.cells_missed.tolist() == found.repeats.tolist() == [0, 0, 0, 0]
    assert found.longest_holding_time.tolist() == [1, 1, 1, 1]
    assert not found.separated.any()
    assert found.r_hat.shape == found.ess_tail.shape == found.mcse_mean.shape == (3,)


# -- stuck chains


def all_frozen(draws):
    return np.tile(draws[:1, :1], (4, 4000, 1))


def each_frozen_elsewhere(draws):
    return np.tile(draws[:, :1], (1, 4000, 1))


def one_frozen_in_the_middle(draws):
    return with_chain(draws, 2, np.median(draws, axis=(0, 1)))


def frozen_in_one_coordinate(draws):
    draws = draws.copy()
    draws[3, :, 1] = draws[3, 0, 1]
    return draws


def frozen_towards_the_end(draws):
    draws = draws.copy()
    draws[0, 3700:] = draws[0, 3700]
    return draws


def one_room_each(draws):
    """Two chains in the room on the left, two in the one on the right."""
    left = np.array([1, -1, 1, -1])[:, None]
    return np.concatenate([(left * np.abs(draws[:, :, 0]))[:, :, None], draws[:, :, 1:]], axis=2)


def opposite_quarters_each(draws):
    """Every coordinate alone has the same law in all chains, and mixes."""
    draws = draws.copy()
    sign = np.where(draws[:, :, 0] > 0, 1, -1) * np.array([1, -1, 1, -1])[:, None]
    draws[:, :, 1] = sign * np.abs(autoregressive(0.5, 4, 4000, 1, seed=1)[:, :, 0])
    return draws


def one_left_out_of_a_corner(draws):
    """Chain 1 never enters the quarter x, y > 0; the others do."""
    draws = draws.copy()
    out = (draws[1, :, :2] > 0).all(axis=1)
    draws[1, out, :2] *= [1, -1]
    return draws


def slow(draws):
    return np.cumsum(draws, axis=1)


def tiny_steps(draws):
    return draws[:1, :1] + 1e-9 * np.cumsum(draws, axis=1)


def with_chain(draws, chain, points):
    draws = draws.copy()
    draws[chain] = points
    return draws


@pytest.mark.parametrize(
    ('spoilt', 'reason'),
    [
        (all_frozen, 'chain 0 never moved; chain 1 never moved'),
        (each_frozen_elsewhere, 'chain 3 never moved'),
        (one_frozen_in_the_middle, 'not converged: chain 2 never moved;'),
        (frozen_in_one_coordinate, 'chain 3 never moved in coordinate 1'),
        (frozen_towards_the_end, 'chain 0 stayed on one point for 300 draws'),
        (one_room_each, 'chain 0 never entered 8 of 16 cells'),
        (opposite_quarters_each, 'of 16 cells of equal weight'),
        (one_left_out_of_a_corner, 'chain 1 never entered'),
        (slow, 'R-hat of coordinate'),
        (tiny_steps, 'effective draws in the middle, below 400'),
        (lambda draws: draws[:1], 'one chain cannot show whether another would agree'),
        (lambda draws: draws[:, :50], 'effective draws in the tails, below 400'),
    ],
    ids=lambda value: getattr(value, '__name__', ''),
)
def test_what_is_stuck_is_never_called_converged(spoilt, reason):
    found = diagnose(spoilt(DRAWS))
    assert not found.converged
    assert reason in found.message


def test_r_hat_alone_and_effective_sizes_alone_would_have_passed_some():
    """So the other statistics are needed."""
    hidden = diagnose(opposite_quarters_each(DRAWS))
    assert hidden.r_hat.max() < 1.01
    assert min(hidden.ess_bulk.min(), hidden.ess_tail.min()) > 400
    assert len(hidden.reasons) == 5
    assert hidden.separated.sum() == 8


def test_chains_that_mix_are_hardly_ever_called_confined():
    """One of 8 mixing chains misses a cell in 1 of a million runs; here are 300 runs."""
    for seed in range(300):
        found = diagnose(autoregressive(0.7, 8, 400, 2, seed))
        assert not found.cells_missed.any(), seed


def test_real_walks_in_a_hall_converge_and_in_narrow_rooms_do_not():
    hall = GridSpace.from_blocked(np.zeros((20, 20), bool))
    assert diagnose(sample(hall, (3.5, 2.5), 1500, n_chains=4, burn_in=50, seed=1)).converged
    walls = np.zeros((41, 41), bool)
    walls[:, 20] = True
    walls[20, 20] = False
    rooms = GridSpace.from_blocked(walls)
    found = diagnose(sample(rooms, (3.5, 2.5), 1500, n_chains=4, burn_in=50, seed=1))
    assert not found.converged
    assert found.autocorrelation_time.max() > 20


def test_repeated_draws_are_counted_for_a_walk_that_cannot_move():
    """Along the axes, in a corridor one cell wide, the walk always moves."""
    space = GridSpace.from_blocked(maps.CORRIDOR)
    draws = sample(space, (0.5, 0.5), 500, walk='coordinate_hit_and_run', n_chains=2, seed=2)
    assert diagnose(draws).repeats.tolist() == [0, 0]


@pytest.mark.parametrize(
    ('draws', 'words'),
    [
        (np.zeros((4, 100)), r'draws must have shape .* got \(4, 100\)'),
        (np.zeros((4, 3, 2)), r'n_draws at least 4, got \(4, 3, 2\)'),
        (np.zeros((0, 10, 2)), r'got \(0, 10, 2\)'),
        (np.zeros((4, 10, 0)), r'got \(4, 10, 0\)'),
        (with_chain(DRAWS, 1, np.nan), r'got \[nan, nan, nan\] as draw 0 of chain 1'),
        (with_chain(DRAWS, 2, np.inf), r'draws must be finite, got \[inf'),
        ('many', 'draws must be numbers'),
    ],
    ids=lambda value: '' if isinstance(value, np.ndarray) else value,
)
def test_what_is_no_draws_is_refused(draws, words):
    with pytest.raises(RequestError, match=words):
        diagnose(draws)


def test_draws_are_left_as_they_are():
    before = DRAWS.copy()
    diagnose(DRAWS)
    np.testing.assert_array_equal(DRAWS, before)
