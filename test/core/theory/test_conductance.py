"""Flows between cells, cuts and their bracket; two rooms with a door against a closed form."""

import math
from test.core.theory.sets import BALL, CUBE, DISC, L_SET, scattered, two_rooms, U_SET, walked
from test.sweeps import sweep

from hnr_planner.core import BoxSpace, RequestError
from hnr_planner.core.theory import (
    best_cut,
    cell_flow,
    cut_conductance,
    step_probability,
)
import numpy as np
import pytest

N_LINES = 1 << 17

# A small door of width w between two unit rooms: a share w cos(t) of the lines at the angle t
# passes it, with equal parts A(t) of the chord on both sides, so the flow is w / (2 pi) times the
# integral of A cos over the half circle: A cos is 1 where |tan t| < 1/2 (the far wall), else
# cot(t) / 2.
SMALL_DOOR = (2 * math.atan(0.5) + math.log(math.sqrt(5))) / (2 * math.pi)


@pytest.mark.parametrize('space', [DISC, L_SET, U_SET], ids=['disc', 'ell', 'you'])
def test_flow_is_symmetric_and_keeps_the_area(space):
    flow = cell_flow(space, (6, 5), N_LINES)
    assert (flow.flow == flow.flow.T).all()
    assert flow.flow.sum(axis=1) == pytest.approx(flow.area, rel=1e-9)
    assert flow.kernel.sum(axis=1) == pytest.approx(1, rel=1e-9)
    exact = math.pi if space is DISC else (~space.blocked).sum()
    assert flow.area.sum() == pytest.approx(exact, rel=2e-3)


def test_flow_between_cells_is_the_mean_of_the_steps():
    """P_u(A) by quadrature over angle, and over u by Gauss's rule in the cell."""
    flow = cell_flow(U_SET, (3, 7), 1 << 19)
    nodes, weights = np.polynomial.legendre.leggauss(4)
    box = BoxSpace((2, 0), (5, 3))
    into = box.contains(flow.centre)
    for k in (0, 7):
        low = flow.centre[k] - (0.5, 1.5)
        mean = 0.0
        for x, p in zip(nodes, weights, strict=True):
            for y, q in zip(nodes, weights, strict=True):
                u = low + ((x + 1) / 2, 3 * (y + 1) / 2)
                mean += p * q / 4 * step_probability(U_SET, u, box)
        assert flow.kernel[k, into].sum() == pytest.approx(mean, rel=0.02)


@pytest.mark.parametrize('door', [sweep(0.05), 0.2])
def test_two_rooms_with_a_door(door):
    """The cut, its closed form, the bracket of Cheeger, and the relaxation time."""
    flow = cell_flow(two_rooms(door), (10, 20), N_LINES)
    cut = best_cut(flow)
    assert cut.inside.sum() == 100
    assert len(set(np.sign(flow.centre[cut.inside, 0] - 1))) == 1
    assert SMALL_DOOR == pytest.approx(0.27565, abs=1e-5)
    assert cut.conductance == pytest.approx(SMALL_DOOR * door, rel=0.012)
    relaxation = flow.relaxation_time
    assert 1 / (2 * cut.conductance) <= relaxation <= 2 / cut.conductance**2
    assert relaxation == pytest.approx({0.05: 37.6, 0.2: 10.35}[door], rel=0.01)


def test_finer_cells_forget_less():
    """The kernel of cells within cells is a projection, so the relaxation time grows with them."""
    rooms = two_rooms(0.2)
    times = [cell_flow(rooms, (m, 2 * m), N_LINES).relaxation_time for m in (2, 4, 8)]
    assert times == sorted(times)
    assert times[-1] / times[0] > 1.05


@pytest.mark.parametrize('n_steps', [5, sweep(20)])
def test_walks_change_sides_as_the_flow_says(n_steps):
    """
    Correlation of the sides that a walk begins and ends on, with a door of .2.

    40 000 walks; 6.5 standard errors, besides 1 % that cells of this size forget.
    """
    rooms, n_walks = two_rooms(0.2), 40_000
    flow = cell_flow(rooms, (10, 20), N_LINES)
    side = np.sign(flow.centre[:, 0] - 1)
    later = np.linalg.matrix_power(flow.kernel, n_steps) @ side
    expected = flow.area @ (side * later) / flow.area.sum()
    begin = scattered(rooms, n_walks, seed=1)
    end = walked(rooms, begin, seed=2, n_steps=n_steps)
    measured = np.mean(np.sign(begin[:, 0] - 1) * np.sign(end[:, 0] - 1))
    assert 0.1 < expected < 0.7
    assert abs(measured - expected) < 0.01 + 6.5 / math.sqrt(n_walks)


@pytest.mark.parametrize(
    ('space', 'side'),
    [
        sweep(two_rooms(0.2), BoxSpace((-1, -1), (1, 2)), name='rooms'),
        sweep(BALL, BoxSpace((0, -2, -2), (2, 2, 2)), name='ball'),
        pytest.param(CUBE, BoxSpace((0.3, 0, 0), (2, 2, 2)), id='cube'),
    ],
)
def test_random_lines_give_the_cut_in_any_dimension(space, side):
    """100 000 lines against 200 000 steps from the smaller side, at 6.5 standard errors."""
    cut = cut_conductance(space, side, 100_000, 2)
    begin = scattered(space, 200_000, seed=3)
    end = walked(space, begin, seed=4)
    inside = side.contains(begin)
    smaller = min(inside.mean(), 1 - inside.mean())
    crossed = np.mean(inside & ~side.contains(end)) / smaller
    error = math.sqrt(crossed / smaller / 200_000)
    assert abs(cut.value - crossed) < 6.5 * math.hypot(cut.error, error)


def test_cells_are_for_the_plane():
    with pytest.raises(RequestError, match='3 axes'):
        cell_flow(BALL, (2, 2))
