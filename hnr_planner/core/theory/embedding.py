"""
Parameters of the bounds for a sheared disc (paper, Assumptions 2 and 3).

A sheared disc is the image of a disc under a map that preserves volume: its diameter, Lipschitz
constants and curvature are what Lemma 13 needs (``bounds.BallImage``).
"""

import math

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.spaces import BallSpace, ShearedSpace
from hnr_planner.core.theory.bounds import BallImage
from hnr_planner.core.theory.curvature import curve_curvature
import numpy as np
from scipy.spatial.distance import pdist

#: Number of boundary points for the curvature, and stride among them for the diameter.
N_POINTS, STRIDE = 4096, 4


def ball_image(space: ShearedSpace) -> BallImage:
    """
    Compute diameter, Lipschitz constants and curvature of a sheared disc.

    Raises
    ------
    RequestError
        For boxes, whose images have corners; and in more than two dimensions, where a ball that is
        bent until it is not convex has a saddle point on its boundary, so that kappa is infinite.

    """
    if space.dim != 2 or not isinstance(space.base, BallSpace):
        raise RequestError(
            f'the curvature is known for sheared discs, not for a {type(space.base).__name__} in '
            f'{space.dim} dimensions'
        )
    boundary = image_boundary(space, N_POINTS)
    diameter = float(pdist(boundary[::STRIDE]).max())
    kappa = curve_curvature(boundary).kappa
    return BallImage(2, space.base.radius, diameter, space.stretch, space.shrink, kappa)


def image_boundary(space: ShearedSpace, n_points: int) -> Floats:
    """
    Return points (n_points, 2) on the boundary of a sheared disc, counter-clockwise.

    The points are the images of points at equal angles on the circle, in the caller's frame.
    """
    angle = np.arange(n_points) * (2.0 * math.pi / n_points)
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    radius, centre = space.data.radius, space.centre
    return space.image(centre + radius * circle)
