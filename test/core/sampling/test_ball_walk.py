"""The ball walk: its law, and which of its two versions goes through walls."""

from test.core.sampling.chain_steps import step_of

from hnr_planner.core import BallWalk, begin_chains, BoxSpace, DifferenceSpace, sample, walk_on
import numpy as np
import pytest
from scipy import stats

#: Two halls of one size, and a wall between them that is thinner than a step.
HALLS = DifferenceSpace(BoxSpace((0.0, 0.0), (4.0, 1.0)), BoxSpace((1.95, -1.0), (2.05, 2.0)))
START = (0.5, 0.5)
EITHER = pytest.mark.parametrize('segment_visible', [True, False])

#: Each statistical test draws N points with a fixed seed; a right walk fails once in a million.
N, FALSE_ALARM = 100_000, 1e-6


def test_the_walk_of_textbooks_goes_through_a_wall():
    draws = sample(HALLS, START, N, walk=BallWalk(0.4, segment_visible=False), thin=5, seed=1)[0]
    assert HALLS.contains(draws).all()
    assert np.mean(draws[:, 0] > 2.0) == pytest.approx(0.5, abs=0.05)


def test_a_walk_whose_segments_are_visible_stays_on_its_side():
    draws = sample(HALLS, START, N, walk=BallWalk(0.4), thin=5, seed=1)[0]
    assert HALLS.contains(draws).all()
    assert draws[:, 0].max() < 1.95
    some = draws[:2000]
    _, chains = walk_on(HALLS, begin_chains(HALLS, START, seed=1), 0)
    assert chains.steps == 0
    steps, _ = walk_on(HALLS, chains, 2000, walk=BallWalk(0.4))
    path = np.vstack([START, *steps])
    assert HALLS.is_path_free(path)
    assert len(np.unique(some, axis=0)) > 1000


@EITHER
def test_a_step_is_uniform_in_the_ball_or_none(segment_visible: bool):
    """From a fifth of a radius before a wall: the share of steps refused, and the others' law."""
    walk, radius, x = BallWalk(0.4, segment_visible=segment_visible), 0.4, 1.87
    points = np.tile([x, 0.5], (N, 1))
    moved = step_of(walk, HALLS)(points, np.random.default_rng(2))
    offsets = (moved - points) / radius
    stayed = (offsets == 0.0).all(axis=1)
    beyond = moved[:, 0] > 2.0
    assert beyond.any() == (not segment_visible)
    near, far = (_cap((wall - x) / radius) for wall in (1.95, 2.05))
    refused = near if segment_visible else near - far
    assert stats.binomtest(int(stayed.sum()), N, refused).pvalue > FALSE_ALARM
    # Halfway round, away from the wall, the ball is whole.
    away = offsets[~stayed & (offsets[:, 0] < 0.0)]
    assert stats.kstest((away**2).sum(axis=1), 'uniform').pvalue > FALSE_ALARM
    angle = np.arctan2(away[:, 1], -away[:, 0]) / np.pi + 0.5
    assert stats.kstest(angle, 'uniform').pvalue > FALSE_ALARM
    assert stats.binomtest(len(away), N, 0.5).pvalue > FALSE_ALARM
    # Mutants: steps of uniform length, and refused steps that are tried again.
    assert stats.kstest(np.sqrt((away**2).sum(axis=1)), 'uniform').pvalue < FALSE_ALARM
    assert stats.binomtest(len(away), int((~stayed).sum()), 0.5).pvalue < FALSE_ALARM


def _cap(height: float) -> float:
    """Return the share of the unit disc beyond a line at ``height`` from its centre."""
    return float((np.arccos(height) - height * np.sqrt(1.0 - height**2)) / np.pi)


@pytest.mark.parametrize('dim', [2, 10, 50])
def test_with_the_radius_that_it_chooses_it_takes_a_good_part_of_its_steps(dim: int):
    cube = BoxSpace(np.zeros(dim), np.ones(dim))
    chains = begin_chains(cube, np.full(dim, 0.5), seed=1)
    _, chains = walk_on(cube, chains, 1, walk='ball_walk', thin=20_000)
    assert 0.2 < chains.moves / chains.steps < 0.9
