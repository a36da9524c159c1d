"""Curvature of curves and of slices, against circles and ellipses."""

import math

from hnr_planner.core import BallSpace, DifferenceSpace
from hnr_planner.core.theory import curve_curvature, slice_curvature
import numpy as np
import pytest
from scipy.special import ellipe

ANGLE = np.arange(1024) * (2 * math.pi / 1024)


@pytest.mark.parametrize(('a', 'b'), [(1, 1), (2, 0.5), (3, 1)])
def test_an_ellipse(a, b):
    """Largest curvature a / b^2 at the tips, perimeter 4 a E(1 - b^2 / a^2)."""
    curve = curve_curvature(np.stack([a * np.cos(ANGLE), b * np.sin(ANGLE)], axis=1))
    assert curve.largest == pytest.approx(a / b**2)
    assert curve.perimeter == pytest.approx(4 * a * ellipe(1 - (b / a) ** 2))
    assert curve.kappa == curve.largest * curve.perimeter


def test_it_has_no_unit():
    shape = np.stack([2 * np.cos(ANGLE), np.sin(ANGLE) + 0.2 * np.cos(2 * ANGLE)], axis=1)
    kappa = curve_curvature(shape).kappa
    assert curve_curvature(7 * shape[::-1] + 3).kappa == pytest.approx(kappa)
    assert curve_curvature(shape[1:1000:2]).kappa != pytest.approx(kappa)


def test_slices_of_a_ball_are_circles():
    ball = BallSpace((1.0, 2.0, 3.0), 2.0)
    found = slice_curvature(ball, (1.0, 2.5, 4.0), (1, 0, 0), (0, 0.6, 0.8))
    assert found.kappa == pytest.approx(2 * math.pi)
    assert found.largest > 1 / 2


def test_every_closed_curve_turns_once_round():
    """Fenchel: the mean curvature is 2 pi / perimeter at least, so kappa is 2 pi at least."""
    rng = np.random.default_rng(1)
    for _ in range(50):
        waves = rng.normal(size=(2, 2, 5)) / np.arange(1, 6) ** 2
        phases = np.arange(1, 6)[:, None] * ANGLE
        curve = (waves[0] @ np.cos(phases) + waves[1] @ np.sin(phases)).T
        assert curve_curvature(curve).kappa >= 2 * math.pi * (1 - 1e-9)


@pytest.mark.interpreted
def test_a_slice_has_to_be_seen():
    """A centre in the shell does not see all of the slice: what comes out is no smooth curve."""
    shell = DifferenceSpace(BallSpace((0.0, 0.0, 0.0), 2.0), BallSpace((0.0, 0.0, 0.0), 1.0))
    assert slice_curvature(shell, (1.5, 0, 0), (1, 0, 0), (0, 1, 0)).kappa > 1000
