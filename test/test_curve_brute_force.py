"""The checker of trajectories itself: it detects errors and passes what is legal."""

import math
from test.curve_brute_force import (
    Bend,
    car_faults,
    curve_collisions,
    double_integrator_faults,
    Throw,
)

import numpy as np
import pytest

LIMITS = {'max_acceleration': 1.0, 'max_speed': 2.0}
WALL = np.zeros((10, 10), dtype=bool)
WALL[:7, 5] = True
DIAGONAL = np.zeros((10, 10), dtype=bool)
DIAGONAL[4, 4] = DIAGONAL[5, 5] = True

BLOCKED = {
    'into a wall': Throw((2, 2), (2, 0), (0, 0), 2),
    'over the edge of a wall by a millionth': Throw((5.5, 8), (0, -1), (0, 0.5 - 1e-6), 3),
    'out of the map': Throw((2, 2), (-1, 0), (0, 0), 3),
    'between two looks': Throw((4.9, 7.5), (1e3, -501), (0, 0), 2e-3),
    'round into a wall': Bend(2 + 3j, 0.0, 0.3, [0, 20]),
    'backwards into a wall': Bend(6 + 3j + 1, 0.0, 0.0, [-2, 0]),
    'standing in a wall': Throw((5.5, 2), (0, 0), (0, 0), 0),
}
FREE = {
    'over the wall': Throw((2, 6), (1, 2), (0, -0.6), 6),
    'touching the top of the wall': Throw((5.5, 8), (0, -1), (0, 0.5 + 1e-9), 3),
    'round before the wall': Bend(2.5 + 3j, 0.0, 0.45, [0, 20]),
    'standing': Throw((2, 2), (0, 0), (0, 0), 0),
    'along the wall': Throw((5, 1), (0, 1), (0, 0), 4),
}


@pytest.mark.parametrize('curve', BLOCKED.values(), ids=BLOCKED.keys())
def test_every_collision_is_seen(curve):
    assert curve_collisions(curve, WALL)


@pytest.mark.parametrize('curve', FREE.values(), ids=FREE.keys())
def test_what_is_legal_passes(curve):
    assert curve_collisions(curve, WALL) == []


def test_a_squeeze_between_diagonal_cells_is_seen():
    assert curve_collisions(Throw((4, 6), (1, -1), (0, 0), 2), DIAGONAL)
    assert curve_collisions(Throw((4.5, 5.5), (1, -1.1), (0, 0.2), 1), DIAGONAL)
    assert curve_collisions(Bend(4.2 + 5.8j, -math.pi / 4, 1e-3, [0, 2]), DIAGONAL)
    assert curve_collisions(Throw((3, 6.5), (1, -1), (0, 0), 1.2), DIAGONAL) == []


def legal():
    times = np.array([0.0, 1.0, 2.0])
    states = np.array([[2.0, 2, 0, 1], [2.5, 3, 1, 1], [3.0, 4, 0, 1]])
    return times, states, np.array([[1.0, 0], [-1.0, 0]])


MUTANTS = {
    'time goes back': lambda t, x, u: (t[[0, 2, 1]], x, u),
    'time does not begin at 0': lambda t, x, u: (t + 1, x, u),
    'not finite': lambda t, x, u: (t, x * np.nan, u),
    'a control is missing': lambda t, x, u: (t, x, u[:1]),
    'a position jumps': lambda t, x, u: (t, x + np.array([[0], [1e-5], [0]]), u),
    'a velocity jumps': lambda t, x, u: (t, x + np.outer([0, 0, 1], [0, 0, 0, 1e-5]), u),
    'another control': lambda t, x, u: (t, x, u * 0.999),
}


def test_a_legal_trajectory_passes():
    assert double_integrator_faults(*legal(), WALL, **LIMITS) == []


@pytest.mark.parametrize('mutant', MUTANTS.values(), ids=MUTANTS.keys())
def test_every_mutant_is_caught(mutant):
    assert double_integrator_faults(*mutant(*legal()), WALL, **LIMITS)


def test_limits_are_held():
    times, states, controls = legal()
    for limits in ((0.99, 2.0), (1.0, 1.4)):
        named = dict(zip(LIMITS, limits, strict=True))
        assert double_integrator_faults(times, states, controls, WALL, **named)


def test_a_velocity_may_jump_to_zero_at_a_wall_only():
    times, controls = np.array([0.0, 1.0]), np.zeros((1, 2))
    at_wall = np.array([[4 - 1e-7, 2, 1, 0], [5 - 1e-7, 2, 0, 0]])
    assert double_integrator_faults(times, at_wall, controls, WALL, **LIMITS, inelastic=True) == []
    assert double_integrator_faults(times, at_wall, controls, WALL, **LIMITS)
    before = at_wall - np.array([0.01, 0, 0, 0])
    assert double_integrator_faults(times, before, controls, WALL, **LIMITS, inelastic=True)
    slower = at_wall + np.array([[0, 0, 0, 0], [0, 0, 0.5, 0]])
    assert double_integrator_faults(times, slower, controls, WALL, **LIMITS, inelastic=True)


def test_a_car_is_held_to_its_limits_and_equations():
    limits = {'max_acceleration': 1.0, 'max_speed': 1.0, 'max_curvature': 0.5}
    times, controls = np.array([0.0, math.pi]), np.array([[0.0, 0.5]])
    states = np.array([[2, 2, 0, 1], [4, 4, math.pi / 2, 1]], dtype=float)
    assert car_faults(times, states, controls, WALL, **limits) == []
    for name in ('max_speed', 'max_curvature'):
        assert car_faults(times, states, controls, WALL, **{**limits, name: 0.49})
    for k in range(4):
        wrong = states.copy()
        wrong[1, k] += 1e-5
        assert car_faults(times, wrong, controls, WALL, **limits)
    assert car_faults(times, states + [2, 0, 0, 0], controls, WALL, **limits)
