"""
The walk along twists: one step, the law that it keeps, and walks that are wrong.

The chain is run by the package; the uniform law, the chords of one step and the wrong walks are
the test's own. Each p-value has to be above 1e-6 / 30: there are fewer than 30 of them, so that
with fresh seeds one run in a million would fail.
"""

from test.core.spaces.poses.robots import checker, L_SHAPE, RECTANGLE
from test.pose_checker import orbit
from test.sampling_gate import same_law
from test.sweeps import sweep_but

from hnr_planner.core import begin_chains, GridSpace, PoseSpace, sample, walk_on
import numpy as np
import pytest
from scipy import stats

ALPHA = 1e-6 / 30
#: Draws from one pose; exactly uniform poses that take ``N_STEPS`` steps.
N_ONE_STEP, N_UNIFORM, N_STEPS = 4000, 8000, 2
DRIVES = {
    'car': {'drive': 'car', 'min_turning_radius': 0.8},
    'differential': {},
    'omnidirectional': {'drive': 'omnidirectional'},
}


def room(footprint=RECTANGLE, **options):
    """Return the poses in a room of 4 m by 3 m with two obstacles, turned in the map."""
    blocked = np.zeros((30, 40), dtype=bool)
    blocked[:12, 18:20] = blocked[22:, 30:] = True
    return PoseSpace(GridSpace.from_blocked(blocked, 0.1, (2.0, -1.0, 2.5)), footprint, **options)


def uniform(space, n, rng):
    """Return n exactly uniform free poses, by rejection; ``test_contact`` checks ``contains``."""
    lower, upper = space.bounds
    poses = rng.uniform(lower, upper, (8 * n + 200, 3))
    poses = poses[space.contains(poses)][:n]
    assert len(poses) == n
    return poses


def cells(space, poses):
    """Sort poses into 5 x 4 x 6 cells of position and yaw; whatever is out of range into one."""
    places = space.grid.to_cells(poses[:, :2])
    column, row = (places / (8.0, 7.5)).astype(int).T
    turn = np.floor((poses[:, 2] + np.pi) / (np.pi / 3.0)).astype(int)
    inside = (turn >= 0) & (turn < 6)
    return np.where(inside, (row * 5 + column) * 6 + turn, 120)


def package(space, poses, rng):
    """Take one step from each pose by the package."""
    seed = int(rng.integers(2**31))
    chains = begin_chains(space, poses, n_chains=len(poses), seed=seed)
    draws, _ = walk_on(space, chains, 1)
    return draws[:, 0]


def by_hand(space, poses, rng, *, twist, share=1.0, wrap=True):
    """Take one step from each pose by the definition, which arguments make wrong."""
    moved = np.empty_like(poses)
    for k, pose in enumerate(poses):
        u = twist(pose, rng)
        lower, upper = space.chord(pose, u)
        (moved[k],) = orbit(pose, u, [lower + rng.random() * (share * upper - lower)])
    if wrap:
        moved[:, 2] = (moved[:, 2] + np.pi) % (2.0 * np.pi) - np.pi
    return moved


def differential(pose, rng):
    return (1.0, 0.0, 0.0) if rng.random() < 0.5 else (0.0, 0.0, 1.0)


def turning_more_on_the_left(pose, rng):
    """Draw a twist by a law that depends on the pose."""
    probability = 0.95 if pose[0] < 0.0 else 0.05
    return (1.0, 0.0, 0.0) if rng.random() > probability else (0.0, 0.0, 1.0)


WALKS = {
    'right': {'twist': differential},
    'twist depends on the pose': {'twist': turning_more_on_the_left},
    'chord cut ahead': {'twist': differential, 'share': 0.5},
    'yaw not wrapped': {'twist': differential, 'wrap': False},
}


def kept_law(space, step, seed):
    """Return the p-value that uniform poses after some steps are as uniform as others."""
    rng = np.random.default_rng(seed)
    poses = uniform(space, N_UNIFORM, rng)
    for _ in range(N_STEPS):
        poses = step(space, poses, rng)
    return same_law(cells(space, poses), cells(space, uniform(space, 3 * N_UNIFORM, rng)))


@pytest.mark.parametrize('drive', sweep_but(['car'], DRIVES))
def test_the_walk_keeps_the_uniform_law_of_poses(drive):
    space = room(L_SHAPE if drive == 'car' else RECTANGLE, **DRIVES[drive])
    assert kept_law(space, package, seed=1) > ALPHA


@pytest.mark.parametrize('walk', sweep_but(['right', 'chord cut ahead'], WALKS))
def test_the_law_is_kept_by_the_right_walk_alone(walk):
    p = kept_law(room(), lambda *given: by_hand(*given, **WALKS[walk]), seed=2)
    assert (p > ALPHA) == (walk == 'right'), p


def chord_by_search(space, pose, twist):
    """Return the chord by the independent checker: single poses, then bisection."""
    judge, ends = checker(space), []
    for sign in (-1.0, 1.0):
        times = sign * np.arange(1e-3, 6.0, 1e-3)
        free = judge.is_free(orbit(pose, twist, times))
        if free.all():
            return -np.pi / abs(twist[2]), np.pi / abs(twist[2])
        first = int(np.argmin(free))
        good, bad = times[first] - sign * 1e-3, times[first]
        for _ in range(20):
            middle = (good + bad) / 2.0
            good, bad = (
                (middle, bad) if judge.is_free(orbit(pose, twist, [middle])) else (good, middle)
            )
        ends.append((good + bad) / 2.0)
    return tuple(ends)


def steps_from(space, pose, seed):
    """Return for each of many steps from one pose its twist for a speed of 1, and its length."""
    after = sample(space, pose, 1, n_chains=N_ONE_STEP, seed=seed)[:, 0]
    turn = (after[:, 2] - pose[2] + np.pi) % (2.0 * np.pi) - np.pi
    away = after[:, :2] - pose[:2]
    chord = np.hypot(*away.T)
    ahead = away @ np.array([np.cos(pose[2]), np.sin(pose[2])])
    return turn, np.where(chord > 1e-12, np.copysign(chord, ahead), 0.0)


def test_one_step_is_uniform_on_an_independent_chord():
    space, pose = room(), np.array([1.0, -2.0, 0.4])
    pose[:2] = space.grid.from_cells(np.array([10.0, 15.0]))
    turn, along = steps_from(space, pose, seed=3)
    turned = along == 0.0
    assert (np.abs(turn[~turned]) < 1e-12).all()
    assert stats.binomtest(int(turned.sum()), N_ONE_STEP).pvalue > ALPHA
    lower, upper = chord_by_search(space, pose, (1.0, 0.0, 0.0))
    straight = (along[~turned] - lower) / (upper - lower)
    lower, upper = chord_by_search(space, pose, (0.0, 0.0, 1.0))
    spun = (turn[turned] - lower) / (upper - lower)
    for share in (straight, spun):
        assert stats.kstest(share, 'uniform').pvalue > ALPHA


def test_a_car_draws_lines_and_arcs_of_every_curvature_alike():
    space = room(RECTANGLE, **DRIVES['car'])
    pose = np.append(space.grid.from_cells(np.array([10.0, 15.0])), 0.4)
    turn, along = steps_from(space, pose, seed=4)
    is_arc = np.abs(turn) > 1e-12
    assert stats.binomtest(int(is_arc.sum()), N_ONE_STEP).pvalue > ALPHA
    # The chord of an arc of curvature k that turns by a is 2 sin(a / 2) / k.
    curvature = 2.0 * np.sin(turn[is_arc] / 2.0) / along[is_arc]
    most = 1.0 / space.drive.min_turning_radius
    assert np.abs(curvature).max() <= most * (1.0 + 1e-9)
    assert stats.kstest(curvature, 'uniform', (-most, 2.0 * most)).pvalue > ALPHA


def test_draws_are_free_poses_of_the_map_and_repeat_with_the_seed():
    space = room(L_SHAPE, **DRIVES['car'])
    (start,) = uniform(space, 1, np.random.default_rng(5))
    draws = sample(space, start, 500, n_chains=2, seed=6)
    assert checker(space).is_free(draws.reshape(-1, 3)).all()
    np.testing.assert_array_equal(draws, sample(space, start, 500, n_chains=2, seed=6))
