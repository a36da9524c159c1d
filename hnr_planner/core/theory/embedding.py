"""Sets that are images of a disc under a map that keeps area (paper, Assumption 2)."""

from collections.abc import Callable
import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.theory.bounds import BallImage
from hnr_planner.core.theory.curvature import curve_curvature
import numpy as np
from scipy.spatial.distance import pdist

#: Points on the boundary for the curvature, and every so many of them for the diameter.
N_POINTS, STRIDE = 4096, 4


def disc_image(
    radius: float, mapping: Callable[[Floats], Floats], stretch: float, shrink: float
) -> BallImage:
    """
    Measure the image of a disc around 0: what the bounds have to know of it.

    Parameters
    ----------
    radius : float
        Of the disc [m].
    mapping : (k, 2) -> (k, 2)
        One to one, smooth, and with a Jacobian determinant of 1.
    stretch, shrink : float
        Lipschitz constants L_Sigma of the map and L_Omega of its inverse; see ``shear_stretch``.

    """
    boundary = image_boundary(radius, mapping, N_POINTS)
    diameter = float(pdist(boundary[::STRIDE]).max())
    kappa = curve_curvature(boundary).kappa
    return BallImage(2, radius, diameter, stretch, shrink, kappa)


def image_boundary(radius: float, mapping: Callable[[Floats], Floats], n_points: int) -> Floats:
    """Return points (n_points, 2) of the image of a circle around 0, counter-clockwise."""
    angle = np.arange(n_points) * (2.0 * math.pi / n_points)
    return mapping(radius * np.stack([np.cos(angle), np.sin(angle)], axis=1))


def shear_stretch(slope: float) -> float:
    """
    Lipschitz constant of a shear and of its inverse: (s + sqrt(s^2 + 4)) / 2.

    A shear moves points along one axis by a function of the others, whose gradient is at most
    ``slope``. Its derivative has the singular values L, 1 / L and 1.
    """
    return (slope + math.sqrt(slope**2 + 4.0)) / 2.0
