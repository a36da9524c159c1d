"""
Boundary ratio R_epsilon: asymmetry of the boundary around points of a convex set.

Definition (paper, Definition 3): the largest |x - b| / |x - c| over points x at distance epsilon
or more from the boundary, where b is the nearer end of a chord through x and c any boundary point.
"""

import math

from hnr_planner.core.checks import check_point
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.theory.rays import chords, half_sphere
import numpy as np
from numpy.typing import ArrayLike


def boundary_ratio(space: Space, x: ArrayLike, n_directions: int = 4096) -> float:
    """
    Return the largest ``|x - b| / |x - c|`` at one point of a convex set in 2 or 3 dimensions.

    b is the nearer end of a chord through ``x`` (dim,), c any boundary point. The ratio is at
    least 1, since c = b is allowed. The paper's R_epsilon is its supremum over points x.
    """
    x = check_point('x', x, space.dim)
    directions, _ = half_sphere(x, n_directions, space)
    behind, ahead = chords(space, x, directions)
    nearer = np.minimum(behind, ahead)
    return float(nearer.max() / nearer.min())


def ball_boundary_ratio(radius: float, epsilon: float) -> float:
    """
    Return R_epsilon of a ball in any dimension: sqrt(2 radius / epsilon - 1).

    ``epsilon`` is the least distance of a point from the sphere, in the unit of ``radius``.
    At distance epsilon from the sphere, the nearer end of a chord is farthest when the chord is
    perpendicular to the radius: sqrt(epsilon (2 radius - epsilon)).
    """
    return math.sqrt(2.0 * radius / epsilon - 1.0)
