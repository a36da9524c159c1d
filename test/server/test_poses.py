"""Poses along a path, the samples that are shown, and quaternions: arrays in, arrays out."""

import math

from hnr_planner.server.geometry.orientations import (
    normalised,
    product,
    quaternion_of,
    rotated,
    tilt_of,
    yaw_of,
)
from hnr_planner.server.geometry.poses import MOST_POSES, pose_rows
from hnr_planner.server.responses.subsample import subsample_tree
import numpy as np
import pytest


def poses_along(
    path: np.ndarray, spacing: float, final_yaw: float
) -> tuple[np.ndarray, list[float]]:
    """Return the points (n, 2) and the yaw angles [rad] of the poses along a path."""
    rows = pose_rows(path, spacing, quaternion_of(final_yaw))
    assert (rows[:, 2] == 0.0).all()
    return rows[:, :2], [yaw_of(tuple(row)) for row in rows[:, 3:].tolist()]


CORNER = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.25]])


def test_poses_are_at_most_the_spacing_apart_and_keep_every_vertex() -> None:
    points, yaws = poses_along(CORNER, 0.1, 3.0)
    steps = np.hypot(*np.diff(points, axis=0).T)
    assert len(points) == 1 + 10 + 3
    assert steps.max() <= 0.1 + 1e-12
    assert points[10].tolist() == [1.0, 0.0]
    assert points[-1].tolist() == [1.0, 0.25]
    assert yaws == pytest.approx([0.0] * 10 + [math.pi / 2] * 3 + [3.0])


def test_no_spacing_keeps_the_vertices_only() -> None:
    points, yaws = poses_along(CORNER, 0.0, -1.0)
    assert np.array_equal(points, CORNER)
    assert yaws == pytest.approx([0.0, math.pi / 2, -1.0])


def test_segment_without_length_looks_where_the_last_one_did() -> None:
    path = np.array([[0.0, 0.0], [0.0, 0.0], [0.0, 2.0], [0.0, 2.0], [1.0, 2.0]])
    _, yaws = poses_along(path, 0.0, 2.0)
    assert yaws == pytest.approx([math.pi / 2] * 3 + [0.0, 2.0])


def test_path_to_where_it_starts_looks_as_the_goal_does() -> None:
    points, yaws = poses_along(np.array([[1.0, 2.0], [1.0, 2.0]]), 0.1, 0.5)
    assert points.tolist() == [[1.0, 2.0], [1.0, 2.0]]
    assert yaws == pytest.approx([0.5, 0.5])


def test_spacing_gives_way_when_it_would_give_too_many_poses() -> None:
    points, _ = poses_along(np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 1.0]]), 1e-6, 0.0)
    assert len(points) <= MOST_POSES + 3
    assert [1000.0, 0.0] in points.tolist()


def test_no_path_has_no_poses() -> None:
    assert pose_rows(np.empty((0, 2)), 0.1, quaternion_of(0.0)).shape == (0, 7)


def random_tree(size: int, seed: int) -> np.ndarray:
    """Return the parents of a random tree."""
    rng = np.random.default_rng(seed)
    return np.array([-1] + [int(rng.integers(0, row)) for row in range(1, size)])


@pytest.mark.parametrize('limit', [0, 1, 5, 20, 99, 100, 1000])
def test_shown_samples_have_their_own_parents(limit: int) -> None:
    parents = random_tree(100, seed=1)
    rows, shown = subsample_tree(parents, limit)
    assert len(rows) == min(limit, 100)
    assert np.array_equal(rows, np.unique(rows))
    for row, parent in zip(rows, shown, strict=True):
        assert parents[row] == (rows[parent] if parent >= 0 else -1)


def test_branch_of_the_last_sample_is_shown_first_and_the_earliest_next() -> None:
    #       0 - 1 - 2 - 3 - 4, and 5 grows from 0, 6 from 5
    parents = np.array([-1, 0, 1, 2, 3, 0, 5])
    assert subsample_tree(parents, 4).rows.tolist() == [0, 1, 5, 6]
    assert subsample_tree(parents, 4).parents.tolist() == [-1, 0, 0, 2]


def test_chain_that_does_not_fit_shows_its_beginning() -> None:
    parents = np.arange(-1, 99)
    assert subsample_tree(parents, 10).rows.tolist() == list(range(10))


def test_two_roots_stay_roots() -> None:
    parents = np.array([-1, -1, 0, 1, 2, 3])
    rows, shown = subsample_tree(parents, 3)
    assert rows.tolist() == [1, 3, 5] and shown.tolist() == [-1, 0, 1]


@pytest.mark.parametrize('yaw', np.linspace(-3.1, 3.1, 9))
def test_yaw_and_quaternion_are_inverse(yaw: float) -> None:
    assert yaw_of(quaternion_of(yaw)) == pytest.approx(yaw)
    assert tilt_of(quaternion_of(yaw)) == 0.0


@pytest.mark.parametrize('scale', [1e-310, 1e-200, 1.0, 1e300])
def test_any_norm_above_zero_can_be_normalised(scale: float) -> None:
    unit = normalised((0.0, 0.0, 0.6 * scale, 0.8 * scale))
    assert unit == pytest.approx((0.0, 0.0, 0.6, 0.8))


def test_quaternion_without_direction_has_no_normal_form() -> None:
    for bad in ((0.0,) * 4, (math.nan, 0.0, 0.0, 1.0), (0.0, math.inf, 0.0, 1.0)):
        assert normalised(bad) is None


def test_tilt_is_the_angle_to_the_vertical() -> None:
    roll = (math.sin(0.15), 0.0, 0.0, math.cos(0.15))
    assert tilt_of(roll) == pytest.approx(0.3)


def test_rotations_follow_one_another() -> None:
    first, second = quaternion_of(0.4), quaternion_of(1.1)
    assert product(first, second) == pytest.approx(quaternion_of(1.5))
    roll = (math.sin(0.25), 0.0, 0.0, math.cos(0.25))
    vector = (1.0, -2.0, 0.5)
    step_by_step = rotated(rotated(vector, roll), first)
    assert rotated(vector, product(first, roll)) == pytest.approx(step_by_step)


def test_vector_is_turned_by_a_rotation() -> None:
    assert rotated((1.0, 0.0, 3.0), quaternion_of(math.pi / 2)) == pytest.approx((0.0, 1.0, 3.0))
    quarter_roll = (math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5))
    assert rotated((5.0, 1.0, 0.0), quarter_roll) == pytest.approx((5.0, 0.0, 1.0))
