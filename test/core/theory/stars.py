"""Star-shaped sets and divided sets of the page, with their figures."""

from functools import cache
import math
from test.core.theory.sets import CUBE, DISC, SQUARE

from hnr_planner.core import BoxSpace
from hnr_planner.core.theory import (
    ball_walk_conductance,
    corrected_conductance,
    isoperimetry,
    mended_conductance,
    printed_conductance,
    star_boundary,
    star_image,
    star_isoperimetry,
    star_kernel,
)
import numpy as np
from scipy.spatial.distance import pdist
import shapely


def lobes(depth, count):
    """Return the radii of a smooth set with lobes around (0, 0)."""
    return 1.0 + depth * np.cos(count * np.arange(2048) * (2.0 * math.pi / 2048))


#: Smooth star-shaped sets: none of them is convex.
SMOOTH = {'two lobes': lobes(0.3, 2), 'three lobes': lobes(0.2, 3), 'five lobes': lobes(0.15, 5)}
_ANGLES = np.arange(10) * np.pi / 5.0
_RADII = np.where(np.arange(10) % 2 == 0, 1.0, 0.35)
#: Sets of the page on mixing, with the radius of a ball walk there [m].
WALKED = {
    'L': (shapely.box(0, 0, 2, 2) - shapely.box(1, 1, 3, 3), 0.6),
    'star': (
        shapely.Polygon(np.stack([_RADII * np.cos(_ANGLES), _RADII * np.sin(_ANGLES)], axis=1)),
        1.2,
    ),
}


def strip(begin, end):
    """Divide a set by two lines x = const."""
    return lambda points: np.where(points[:, 0] < begin, 1, np.where(points[:, 0] > end, 2, 3))


def corner(begin, end):
    """Divide a set by two lines x + y = const."""
    return lambda points: strip(begin, end)(points.sum(axis=1, keepdims=True))


def ring(begin, end):
    """Divide a set by two circles around (0, 0)."""
    return lambda points: strip(begin, end)(np.linalg.norm(points, axis=1, keepdims=True))


LONG = BoxSpace((0.0, 0.0), (8.0, 1.0))
#: Convex sets, and how each is divided.
DIVIDED = {
    'disc, strip of .1': (DISC, strip(-0.05, 0.05)),
    'disc, ring of .2': (DISC, ring(0.5, 0.7)),
    'square, strip of .01': (SQUARE, strip(0.495, 0.505)),
    'square, corner': (SQUARE, corner(0.3, 0.5)),
    'box of 8 x 1, strip of .8': (LONG, strip(3.6, 4.4)),
    'cube, strip of .2': (CUBE, strip(0.4, 0.6)),
}


@cache
def divided(name):
    """Return both sides of Theorem 7 for one of ``DIVIDED``."""
    return isoperimetry(*DIVIDED[name])


def smooth(name):
    """Return fraction of the kernel, parameters and three bounds of one of ``SMOOTH``."""
    radii = SMOOTH[name]
    polygon = shapely.Polygon(star_boundary(radii)[::8])
    image = star_image(radii)
    bounds = [f(image) for f in (printed_conductance, corrected_conductance, mended_conductance)]
    return star_kernel(polygon).area / polygon.area, image, bounds


def walked(name):
    """Return fraction of the kernel, least acceptance and bound of a ball walk of ``WALKED``."""
    polygon, radius = WALKED[name]
    ring = shapely.get_coordinates(polygon.exterior)
    fraction = star_kernel(polygon).area / polygon.area
    # Least at a corner: the part of the disc that is in the set.
    discs = shapely.buffer(shapely.points(ring), radius, quad_segs=256)
    local = float((shapely.area(shapely.intersection(discs, polygon)) / shapely.area(discs)).min())
    psi = star_isoperimetry(fraction, float(pdist(ring).max()))
    return fraction, local, ball_walk_conductance(psi, radius, local)
