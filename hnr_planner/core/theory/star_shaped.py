"""
Star-shaped sets in the plane: their kernel, and what it bounds.

A set is star-shaped if its kernel, the points from which all of it is visible, is not empty. They
are the sets that were known to be sampled fast before the paper: by the ball walk, if the kernel
is a large fraction of the volume (Chandrasekaran, Dadush and Vempala 2010, cited in Section 1).
Every star-shaped set is also the image of a ball under a map that preserves volume (Fonseca and
Parry 1992, cited after Assumption 2); in the plane ``star_image`` has such a map in closed form,
so that the paper's bounds can be computed for it.
"""

from itertools import pairwise
import math

from hnr_planner.core.checks import check_positive, Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.theory.bounds import BallImage
from hnr_planner.core.theory.curvature import curve_curvature
import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.distance import pdist
import shapely

#: At most so many boundary points count for the diameter.
N_FOR_DIAMETER = 1024


def star_kernel(polygon: shapely.Polygon) -> shapely.Polygon:
    """
    Return the kernel of a polygon: the points from which all of it is visible.

    It is the intersection of the half-planes on the inner side of each edge: empty for a polygon
    that is not star-shaped, or that has a hole.
    """
    if polygon.interiors:
        return shapely.Polygon()
    ring = shapely.get_coordinates(shapely.orient_polygons(polygon).exterior)
    left, bottom, right, top = polygon.bounds
    size = 4.0 * math.hypot(right - left, top - bottom)
    kernel: shapely.Polygon = polygon.envelope
    for start, end in pairwise(ring):
        along = (end - start) / np.linalg.norm(end - start) * size
        inwards = np.array([-along[1], along[0]])
        corners = (start - along, start + along, start + along + inwards, start - along + inwards)
        kernel = kernel.intersection(shapely.Polygon(corners))
    return kernel if kernel.geom_type == 'Polygon' else shapely.Polygon()


def star_boundary(radii: ArrayLike) -> Floats:
    """Return the boundary points (k, 2) of ``radii`` (k,) [m] at equal angles around (0, 0)."""
    radii = np.asarray(radii, dtype=np.float64)
    angle = np.arange(len(radii)) * (2.0 * math.pi / len(radii))
    return np.asarray(radii[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1))


def star_image(radii: ArrayLike) -> BallImage:
    """
    Compute the parameters of the bounds for a smooth star-shaped set in the plane.

    The map takes the disc of equal area to the set: rays to rays, with the area between rays kept,
    and lengths on a ray in proportion. With rho the radius and rho' its derivative, its
    derivative has the entries rho/r, r rho'/rho^2, 0 and r/rho, so that its determinant is 1. It
    is the same along a ray, and extends to the whole plane: the largest singular value is the
    Lipschitz constant of the map and of its inverse.

    Parameters
    ----------
    radii : (k,)
        Distances from (0, 0) to the boundary [m] at k equal angles, which have to resolve it.

    Raises
    ------
    RequestError
        When a radius is not positive, or there are fewer than 8.

    """
    rho = np.asarray(radii, dtype=np.float64)
    if rho.ndim != 1 or len(rho) < 8 or not (np.isfinite(rho) & (rho > 0.0)).all():
        raise RequestError(f'radii must be at least 8 positive numbers, got {radii!r}')
    radius = math.sqrt(float(np.mean(rho**2)))
    frequency = np.fft.fftfreq(len(rho), 1.0 / len(rho))
    slope = np.fft.ifft(1j * frequency * np.fft.fft(rho)).real
    squares = (rho / radius) ** 2 + (radius * slope / rho**2) ** 2 + (radius / rho) ** 2
    largest = float(squares.max())  # s^2 + 1/s^2 of the largest singular value s
    stretch = (math.sqrt(largest + 2.0) + math.sqrt(max(largest - 2.0, 0.0))) / 2.0
    boundary = star_boundary(rho)
    diameter = float(pdist(boundary[:: max(len(rho) // N_FOR_DIAMETER, 1)]).max())
    kappa = curve_curvature(boundary).kappa
    return BallImage(2, radius, diameter, stretch, stretch, kappa)


def star_isoperimetry(fraction: float, diameter: float) -> float:
    """
    Return psi of the isoperimetric inequality of star-shaped sets in the plane [1/m].

    For any division in three parts, vol(third) >= psi d(first, second) min(vol(first),
    vol(second)), with psi = 3 eta / (16 D); eta is the ``fraction`` of the area in the kernel, D
    the ``diameter`` [m]. A point x drawn from the kernel sees a point y drawn from the part that
    has less of the kernel. Where x lies in the other part, the third has at least d / D of the
    segment between them; and a random point of that segment has a density of at most
    1 / vol(kernel) + 1 / vol(part).
    """
    fraction = check_positive('fraction', fraction)
    return 3.0 * fraction / (16.0 * check_positive('diameter', diameter))


def ball_walk_conductance(psi: float, radius: float, local: float) -> float:
    """
    Return a bound from below on the conductance of the ball walk in the plane.

    The walk accepts a uniform point of the disc of ``radius`` delta [m] around its position if it
    is in the set. ``local`` is the least probability lambda that it is. Two positions less than
    pi lambda delta / 4 apart share at least lambda / 2 of their steps, so that the conductance is
    at least min(lambda / 8, pi lambda^2 delta psi / 64), with ``psi`` [1/m] of the isoperimetric
    inequality.
    """
    return min(local / 8.0, math.pi * local**2 * radius * psi / 64.0)
