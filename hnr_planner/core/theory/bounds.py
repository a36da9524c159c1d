"""
The paper's chain of bounds: from the shape of a set to a mixing time, as printed and mended.

Lemma 13 bounds the conductance of Hit-and-Run on Sigma = g(Omega) from below, where Omega is a
ball and g keeps volume (Assumption 2). As printed it has three slips, and its proof has gaps;
``docs/theory.md`` says which. So there are three versions of it:

- ``printed``: the formula as it stands;
- ``corrected``: its units put right, and two factors that the proof loses on the way;
- ``mended``: besides, what the proof needs where a step of it fails.
"""

from dataclasses import dataclass
import math

from hnr_planner.core.theory.boundary_ratio import ball_boundary_ratio
from hnr_planner.core.theory.density import log_ball_volume

SIN_8 = math.sin(math.pi / 8.0)


@dataclass(frozen=True)
class BallImage:
    """
    What the bounds have to know of a set that is the image of a ball.

    Attributes
    ----------
    dim : int
        Dimension n.
    radius : float
        r, of the ball [m].
    diameter : float
        D_Sigma, of the image [m].
    stretch, shrink : float
        L_Sigma and L_Omega: Lipschitz constants of the map and of its inverse.
    kappa : float
        Curvature of the image (Assumption 3).

    """

    dim: int
    radius: float
    diameter: float
    stretch: float = 1.0
    shrink: float = 1.0
    kappa: float = 2.0 * math.pi

    @classmethod
    def unit_ball(cls, dim: int) -> 'BallImage':
        """Return the ball of volume 1, mapped by the identity (paper, Assumption 4)."""
        radius = math.exp(-log_ball_volume(dim) / dim)
        return cls(dim, radius, 2.0 * radius)

    @property
    def depth(self) -> float:
        """Depth epsilon'' = 9 r / (20 n L_Omega) below the boundary of Sigma (Lemma 13) [m]."""
        return 9.0 * self.radius / (20.0 * self.dim * self.shrink)

    @property
    def ratio_bound(self) -> float:
        """Factor 4 L_Sigma^2 L_Omega^2 R (1 + 2 R) of Lemma 10 at epsilon' = 9 r / (20 n)."""
        return lipschitz_factor(self, 9.0 * self.radius / (20.0 * self.dim))


def ratio_inequality(ratio: float) -> float:
    """Right-hand side 1 / (4 R (1 + 2 R)) of Lemma 8."""
    return 1.0 / (4.0 * ratio * (1.0 + 2.0 * ratio))


def lipschitz_factor(image: BallImage, epsilon: float) -> float:
    """Return how often d-tilde on Sigma can hold d on Omega, epsilon inside (Lemma 10)."""
    ratio = ball_boundary_ratio(image.radius, epsilon)
    return (image.stretch * image.shrink) ** 2 / ratio_inequality(ratio)


def view_bound(kappa: float, apart: float, epsilon: float) -> float:
    """Bound max(4/pi, kappa / sin(pi/8)) epsilon'/epsilon on what one point misses (Lemma 11)."""
    return max(4.0 / math.pi, kappa / SIN_8) * apart / epsilon


def mended_view_bound(dim: int, kappa: float, apart: float, epsilon: float) -> float:
    """
    Lemma 11 with two steps of its proof put right.

    An angle is at most pi/2 times its sine; and a uniform line through u makes the angle t with
    [u, v] with density c sin(t)^(n-2), not 1/pi: c pi is 1 in the plane and grows like sqrt(n).
    """
    log_peak = math.lgamma(dim / 2.0) - math.lgamma((dim - 1) / 2.0)
    peak = math.sqrt(math.pi) * math.exp(log_peak)
    return math.pi / 2.0 * peak * view_bound(kappa, apart, epsilon)


def variation_bound(epsilon: float, diameter: float) -> float:
    """Bound 1 - epsilon / (8 e^4 D) on the total variation distance of two steps (Lemma 12)."""
    return 1.0 - epsilon / (8.0 * math.exp(4.0) * diameter)


def printed_conductance(image: BallImage) -> float:
    """Lemma 13 as printed: (delta/4) (2/(5 n D) ^ N (1/(24 D) ^ (2/sqrt n)(1/(8 sqrt n) ^ G)))."""
    n, turn = image.dim, _closeness(image.kappa)
    delta = image.depth / (16.0 * math.exp(4.0) * image.diameter)
    scale = image.depth / image.ratio_bound
    near = 2.0 / math.sqrt(n) * min(1.0 / (8.0 * math.sqrt(n)), turn)
    first = 2.0 / (5.0 * n * 2.0 * image.radius)
    return delta / 4.0 * min(first, scale * min(1.0 / (24.0 * image.diameter), near))


def corrected_conductance(image: BallImage) -> float:
    """Lemma 13 with r for 2 in the first branch, 4/D for 2/sqrt n, and delta/24 for delta/4."""
    n, turn = image.dim, _closeness(image.kappa)
    delta = image.depth / (16.0 * math.exp(4.0) * image.diameter)
    scale = image.depth / image.ratio_bound
    near = 4.0 / image.diameter * min(1.0 / (8.0 * math.sqrt(n)), turn)
    first = image.radius / (5.0 * n * 2.0 * image.radius)
    return delta / 24.0 * min(first, scale * min(1.0 / (24.0 * image.diameter), near))


def mended_conductance(image: BallImage) -> float:
    """
    Lemma 13 with its proof mended where we saw it fail, but for one gap.

    Besides ``corrected_conductance``: e^6 for e^4, since the cap of Lemma 12 has to be cut at
    2/sqrt n; the views of ``mended_view_bound``; and, since d-tilde <= d_Sigma, the second branch
    by way of the distance: d_Sigma >= e/(24 D) at depth e makes |u - v| >= e^2/(72 D), and so
    d-tilde >= e^2/(18 D^2).
    """
    n = image.dim
    turn = 1.0 / (6.0 * mended_view_bound(n, image.kappa, 1.0, 1.0))
    delta = image.depth / (16.0 * math.exp(6.0) * image.diameter)
    scale = image.depth / image.ratio_bound
    near = 4.0 / image.diameter * min(1.0 / (8.0 * math.sqrt(n)), turn)
    far = image.depth / (18.0 * image.diameter**2)
    first = image.radius / (5.0 * n * 2.0 * image.radius)
    return delta / 24.0 * min(first, scale * min(far, near))


def mixing_bound(conductance: float, warmth: float, epsilon: float) -> float:
    """
    Return the steps until every set has its probability to within ``epsilon`` (Lemma 6).

    The first t with sqrt(M) (1 - Phi^2 / 2)^t <= epsilon, where the ``warmth`` M bounds the
    density at the start. It is infinite for a start at a point, and until the n-th step from one.
    """
    return math.log(math.sqrt(warmth) / epsilon) / -math.log1p(-(conductance**2) / 2.0)


def _closeness(kappa: float) -> float:
    """Return G = (1/6) min(pi/4, sin(pi/8) / kappa) of Lemmas 12 and 13."""
    return min(math.pi / 4.0, SIN_8 / kappa) / 6.0
