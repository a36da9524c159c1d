"""Words of Reeds and Shepp and of Dubins, and connections: they end where they have to."""

from test.core.spaces.poses.robots import RECTANGLE
from test.pose_checker import orbit

from hnr_planner.core import GridSpace, PoseSpace
from hnr_planner.core.kernels.kernel import interpreted
from hnr_planner.core.planning.poses import connections as module
from hnr_planner.core.planning.poses.reeds_shepp import (
    N_DUBINS,
    N_FORMULAS,
    N_SYMMETRIES,
    word,
    WordPrices,
)
import numpy as np
import pytest

RADIUS = 0.8
DRIVES = {
    'car': {'drive': 'car', 'min_turning_radius': RADIUS},
    'car ahead': {'drive': 'car', 'min_turning_radius': RADIUS, 'reverse': False},
    'differential': {},
    'differential ahead': {'reverse': False},
    'omnidirectional': {'drive': 'omnidirectional'},
}
GRID = GridSpace.from_blocked(np.zeros((80, 80), dtype=bool), 0.1)


@pytest.fixture
def rng():
    return np.random.default_rng(20160823)


def driven(pose, twists):
    """Return the pose after the motions of a path."""
    for twist in twists:
        (pose,) = orbit(pose, twist, [1.0])
    return pose


def is_same(a, b):
    turn = (a[2] - b[2] + np.pi) % (2.0 * np.pi) - np.pi
    return np.abs([*(a - b)[:2], turn]).max() < 1e-8


def words(goal, forwards):
    """Return the twists of every word to a goal, for radius 1."""
    found = []
    for formula in range(N_DUBINS if forwards else N_FORMULAS):
        for symmetry in (0, 2) if forwards else range(N_SYMMETRIES):
            lengths, bends = np.zeros(5), np.zeros(5)
            turn = np.cos(goal[2]), np.sin(goal[2])
            prices = WordPrices(1.0, 1.0, 0.0)
            n = interpreted(word)(
                formula, symmetry, forwards, *goal, *turn, prices, np.inf, lengths, bends
            )
            if n:
                twists = np.column_stack([lengths, np.zeros(5), bends * lengths])[:n]
                found.append(twists)
    return found


def test_every_word_ends_at_the_goal(rng):
    used = 0
    for _ in range(150):
        goal = np.append(rng.normal(size=2) * rng.choice([0.3, 1.0, 4.0]), rng.uniform(-3, 3))
        for forwards in (False, True):
            for twists in words(goal, forwards):
                used += 1
                assert is_same(driven(np.zeros(3), twists), goal), (goal, twists)
                assert not forwards or (twists[:, 0] >= 0.0).all()
    assert used > 2000


def length(twists):
    return np.abs(twists[:, 0]).sum()


@pytest.mark.parametrize(
    ('goal', 'shortest', 'ahead'),
    [
        ((5.0, 0.0, 0.0), 5.0, 5.0),
        ((-5.0, 0.0, 0.0), 5.0, None),
        ((1.0, 1.0, np.pi / 2), np.pi / 2, np.pi / 2),
        ((0.0, 2.0, np.pi), np.pi, np.pi),
        # Turned round on the spot: three arcs of 60 degrees, known as the shortest.
        ((0.0, 0.0, -np.pi), np.pi, 7.0 * np.pi / 3.0),
    ],
)
def test_the_shortest_words_have_known_lengths(goal, shortest, ahead):
    assert min(map(length, words(np.array(goal), False))) == pytest.approx(shortest)
    if ahead is not None:
        assert min(map(length, words(np.array(goal), True))) == pytest.approx(ahead)


@pytest.mark.parametrize('name', DRIVES)
@pytest.mark.parametrize('way', [1.0, -1.0])
def test_connections_end_at_the_pose_and_are_what_the_drive_can_do(name, way, rng):
    space = PoseSpace(GRID, RECTANGLE, **DRIVES[name])
    prices = module.Prices(2.0, 10.0, 3.0)
    found = module.empty_connections()
    for _ in range(40):
        a, b = rng.uniform((0, 0, -np.pi), (80, 80, np.pi), (2, 3))
        interpreted(module.connect)(space.data, prices, a, b, way, found)
        costs = found.costs[: module.N_KEPT]
        assert np.isfinite(costs[0])
        assert (np.diff(costs[np.isfinite(costs)]) >= 0.0).all()
        for k in np.flatnonzero(np.isfinite(costs)):
            twists = found.twists[k, : found.sizes[k]]
            assert is_same(driven(a, twists), b)
            vx, vy, omega = (way * twists).T
            if 'ahead' in name:
                assert (vx >= 0.0).all()
            if name != 'omnidirectional':
                assert (vy == 0.0).all()
            if 'car' in name:
                least = RADIUS / GRID.resolution * (1.0 - 1e-9)
                assert (np.abs(vx) >= least * np.abs(omega)).all()
            if 'differential' in name:
                least = np.hypot(*np.transpose(RECTANGLE)).max() / GRID.resolution * (1.0 - 1e-9)
                turning = vx != 0.0
                assert (np.abs(vx) >= least * np.abs(omega))[turning].all()


@pytest.mark.parametrize('name', DRIVES)
@pytest.mark.parametrize('way', [1.0, -1.0])
def test_a_limit_leaves_out_no_connection_that_costs_less(name, way, rng):
    space = PoseSpace(GRID, RECTANGLE, **DRIVES[name])
    prices = module.Prices(2.0, 10.0, 3.0)
    every, some = (module.empty_connections() for _ in range(2))
    n_compared = 0
    for scale in np.repeat([1.0, 10.0, 80.0], 5):
        a = rng.uniform((0, 0, -np.pi), (80, 80, np.pi))
        b = a + scale * rng.normal(size=3) * (1.0, 1.0, 0.1)
        interpreted(module.connect)(space.data, prices, a, b, way, every)
        limit = rng.choice(every.costs[: module.N_KEPT]) * (1.0 + 1e-6)
        interpreted(module.connect_below)(space.data, prices, a, b, way, limit, some)
        below = every.costs[: module.N_KEPT] < limit
        np.testing.assert_array_equal(
            every.costs[: module.N_KEPT][below], some.costs[: module.N_KEPT][below]
        )
        n_compared += below.sum()
    assert n_compared > 15


@pytest.mark.parametrize('rest', [0.0, 1e-16, 1e-9, 1e-3])
def test_a_turn_in_place_costs_the_same_with_any_tiny_move(rest, rng):
    prices = module.Prices(2.0, 10.0, 3.0)
    for turn in rng.uniform(-np.pi, np.pi, 20):
        for vx, vy in ((rest, 0.0), (-rest, 0.0), (0.0, rest), (rest, -rest)):
            cost = interpreted(module.motion_cost)(prices, vx, vy, turn, 1.0)
            assert cost == pytest.approx(3.0 * abs(turn), abs=2.0 * rest)


def test_an_omnidirectional_robot_pays_for_a_turn_that_ends_beside_where_it_began(rng):
    space = PoseSpace(GRID, RECTANGLE, **DRIVES['omnidirectional'])
    prices = module.Prices(2.0, 10.0, 3.0)
    found = module.empty_connections()
    a = np.array([40.0, 40.0, 0.0])
    for rest in (0.0, 1e-16, 1e-12, 1e-6):
        b = a + (rest * rng.choice([-1.0, 1.0]), rest, 2.0)
        interpreted(module.connect)(space.data, prices, a, b, 1.0, found)
        assert found.costs[0] == pytest.approx(3.0 * 2.0, rel=1e-5)
