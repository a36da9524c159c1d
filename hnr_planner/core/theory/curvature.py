"""
Curvature kappa of a set.

Definition (paper, Assumption 3): the supremum, over the plane slices H of the set, of the largest
curvature kappa_H of the slice's boundary times its perimeter R_H.
"""

import math
from typing import NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.rays import reach
import numpy as np
from numpy.typing import ArrayLike


class Curvature(NamedTuple):
    """
    Curvature and perimeter of one closed curve.

    Attributes
    ----------
    largest : float
        Largest curvature [1/m].
    perimeter : float
        Length of the curve [m].

    """

    largest: float
    perimeter: float

    @property
    def kappa(self) -> float:
        """Product kappa_H R_H of the paper: no unit, at least 2 pi, infinite at corners."""
        return self.largest * self.perimeter


def curve_curvature(points: Floats) -> Curvature:
    """
    Return the curvature of a smooth closed curve in the plane.

    Parameters
    ----------
    points : (k, 2)
        Points at k equal steps of a smooth periodic parameter. Derivatives are those of the
        trigonometric interpolant, so that k has to resolve the sharpest turn.

    """
    curve = points[:, 0] + 1j * points[:, 1]
    k = len(curve)
    frequency = np.fft.fftfreq(k, 1.0 / k)
    if k % 2 == 0:
        frequency[k // 2] = 0.0  # the derivative of the Nyquist mode vanishes at the points
    spectrum = np.fft.fft(curve)
    velocity = np.fft.ifft(1j * frequency * spectrum)
    acceleration = np.fft.ifft(-(frequency**2) * spectrum)
    speed = np.abs(velocity)
    turning = np.abs((velocity.conj() * acceleration).imag) / speed**3
    return Curvature(float(turning.max()), 2.0 * math.pi * float(speed.mean()))


def slice_curvature(
    space: Space, centre: ArrayLike, first: ArrayLike, second: ArrayLike, n_points: int = 4096
) -> Curvature:
    """
    Return the curvature of the boundary of a plane slice that is star-shaped about ``centre``.

    Of a slice with several components, only the component that contains ``centre`` counts: its
    curvature times perimeter is a lower bound on the paper's kappa_H R_H.

    Parameters
    ----------
    space : Space
        The set.
    centre : (dim,)
        A free point from which all of the slice's boundary is visible.
    first, second : (dim,)
        Orthogonal unit vectors that span the plane of the slice.
    n_points : int
        Number of points on the boundary.

    """
    angle = np.arange(n_points) * (2.0 * math.pi / n_points)
    flat = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    directions = flat @ np.stack([np.asarray(first, float), np.asarray(second, float)])
    return curve_curvature(reach(space, np.asarray(centre, float), directions)[:, None] * flat)
