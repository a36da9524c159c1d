"""
The paper's bounds: from the shape of a set to conductance and mixing time (Lemmas 6 to 13).

Lemma 13 bounds the conductance Phi of Hit-and-Run on Sigma = g(Omega) from below, where Omega is a
ball and g preserves volume (Assumption 2). As printed, the formula has three errors and its proof
has gaps, which ``docs/theory.md`` lists. So there are three versions of the bound:

- ``printed``: the formula as printed;
- ``corrected``: with correct units, and with two factors that the proof loses;
- ``mended``: also with the changes that the proof needs where one of its steps fails.

Lemma 6 turns a bound on Phi into a number of steps: ``mixing_bound``.
"""

from dataclasses import dataclass
import math

from hnr_planner.core.errors import RequestError
from hnr_planner.core.theory.boundary_ratio import ball_boundary_ratio
from hnr_planner.core.theory.density import log_ball_volume

SIN_8 = math.sin(math.pi / 8.0)


@dataclass(frozen=True)
class BallImage:
    """
    Parameters of the bounds for a set that is the image of a ball.

    Attributes
    ----------
    dim : int
        Dimension n.
    radius : float
        Radius r of the ball [m].
    diameter : float
        Diameter D_Sigma of the image [m].
    stretch, shrink : float
        Lipschitz constants of the map (L_Sigma) and of its inverse (L_Omega): at least 1, since
        the map keeps the volume (equation (1)).
    kappa : float
        Curvature of the image (Assumption 3), without unit.

    Raises
    ------
    RequestError
        When a Lipschitz constant is below 1.

    """

    dim: int
    radius: float
    diameter: float
    stretch: float = 1.0
    shrink: float = 1.0
    kappa: float = 2.0 * math.pi

    def __post_init__(self) -> None:
        """Check equation (1); a relative 1e-9 is left to rounding."""
        for name, value in (('stretch', self.stretch), ('shrink', self.shrink)):
            if not value >= 1.0 - 1e-9:
                raise RequestError(f'{name} must be at least 1 (equation (1)), got {value!r}')

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
    """Return the right-hand side 1 / (4 R (1 + 2 R)) of Lemma 8, for the boundary ratio R."""
    return 1.0 / (4.0 * ratio * (1.0 + 2.0 * ratio))


def lipschitz_factor(image: BallImage, epsilon: float) -> float:
    """
    Return the bound of Lemma 10 on the ratio of d on Omega to d-tilde on Sigma.

    It holds for points of the ball Omega at distance ``epsilon`` [m] or more from its boundary. d
    is the cross-ratio distance, d-tilde the chain distance of the images in Sigma.
    """
    ratio = ball_boundary_ratio(image.radius, epsilon)
    return (image.stretch * image.shrink) ** 2 / ratio_inequality(ratio)


def view_bound(kappa: float, distance: float, epsilon: float) -> float:
    """
    Return the bound of Lemma 11 on the probability that a step from u is not visible from v.

    It is ``max(4/pi, kappa / sin(pi/8)) |u - v| / epsilon``, for u and v at least ``epsilon``
    from the boundary and ``distance`` from each other [m].
    """
    return max(4.0 / math.pi, kappa / SIN_8) * distance / epsilon


def mended_view_bound(dim: int, kappa: float, distance: float, epsilon: float) -> float:
    """
    Return the bound of Lemma 11 with two steps of its proof corrected.

    An angle is at most pi/2 times its sine; and a uniform line through u makes the angle t with
    [u, v] with density c sin(t)^(n-2), not 1/pi: c pi is 1 in the plane and grows like sqrt(n).
    """
    log_peak = math.lgamma(dim / 2.0) - math.lgamma((dim - 1) / 2.0)
    peak = math.sqrt(math.pi) * math.exp(log_peak)
    return math.pi / 2.0 * peak * view_bound(kappa, distance, epsilon)


def variation_bound(epsilon: float, diameter: float) -> float:
    """
    Return 1 - epsilon / (8 e^4 D), the bound of Lemma 12 on a total variation distance.

    The distance is that between the distributions of a step from u and of a step from v, for two
    points that are close in the sense of Lemma 12 and at least ``epsilon`` [m] from the boundary;
    D is the ``diameter`` of the set [m].
    """
    return 1.0 - epsilon / (8.0 * math.exp(4.0) * diameter)


def printed_conductance(image: BallImage) -> float:
    """
    Return the bound of Lemma 13 on Phi, as printed.

    (delta/4) min(2/(5 n d), N min(1/(24 D), (2/sqrt n) min(1/(8 sqrt n), G))), where d is the
    diameter of the ball, D that of the image, delta = ``depth`` / (16 e^4 D), N = ``depth`` /
    ``ratio_bound``, and G the closeness of Lemma 12.
    """
    n, closeness = image.dim, _closeness(image.kappa)
    delta = image.depth / (16.0 * math.exp(4.0) * image.diameter)
    scale = image.depth / image.ratio_bound
    near = 2.0 / math.sqrt(n) * min(1.0 / (8.0 * math.sqrt(n)), closeness)
    first = 2.0 / (5.0 * n * 2.0 * image.radius)
    return delta / 4.0 * min(first, scale * min(1.0 / (24.0 * image.diameter), near))


def corrected_conductance(image: BallImage) -> float:
    """
    Return the bound of Lemma 13 on Phi, with the three errors of the formula corrected.

    In the formula of ``printed_conductance`` the ball's radius replaces the numerator 2 of the
    first fraction, 4/D replaces 2/sqrt n, and delta/24 replaces delta/4.
    """
    n, closeness = image.dim, _closeness(image.kappa)
    delta = image.depth / (16.0 * math.exp(4.0) * image.diameter)
    scale = image.depth / image.ratio_bound
    near = 4.0 / image.diameter * min(1.0 / (8.0 * math.sqrt(n)), closeness)
    first = image.radius / (5.0 * n * 2.0 * image.radius)
    return delta / 24.0 * min(first, scale * min(1.0 / (24.0 * image.diameter), near))


def mended_conductance(image: BallImage) -> float:
    """
    Return the bound of Lemma 13 on Phi, with its proof mended but for one gap.

    Besides the corrections of ``corrected_conductance``: e^6 replaces e^4, since the cap of
    Lemma 12 has to be cut at 2/sqrt n; Lemma 11 is that of ``mended_view_bound``; and, since
    d-tilde <= d_Sigma, the second branch uses the distance: d_Sigma >= e/(24 D) at depth e makes
    ``|u - v| >= e^2/(72 D)``, and so d-tilde >= e^2/(18 D^2).
    """
    n = image.dim
    closeness = 1.0 / (6.0 * mended_view_bound(n, image.kappa, 1.0, 1.0))
    delta = image.depth / (16.0 * math.exp(6.0) * image.diameter)
    scale = image.depth / image.ratio_bound
    near = 4.0 / image.diameter * min(1.0 / (8.0 * math.sqrt(n)), closeness)
    far = image.depth / (18.0 * image.diameter**2)
    first = image.radius / (5.0 * n * 2.0 * image.radius)
    return delta / 24.0 * min(first, scale * min(far, near))


def mixing_bound(conductance: float, warmth: float, epsilon: float) -> float:
    """
    Return the number of steps after which the walk has mixed to within ``epsilon`` (Lemma 6).

    After so many steps the probability that the walk is in a subset differs from the subset's
    fraction of the volume by at most ``epsilon``, for every subset. The number, which need not be
    whole, solves sqrt(M) (1 - Phi^2 / 2)^t = epsilon. ``conductance`` is Phi. The ``warmth`` M is
    the largest ratio of the density of the start to the uniform density: M is infinite for a start
    at a point, and the density after each of the first n steps is still unbounded.
    """
    return math.log(math.sqrt(warmth) / epsilon) / -math.log1p(-(conductance**2) / 2.0)


def _closeness(kappa: float) -> float:
    """Return G = (1/6) min(pi/4, sin(pi/8) / kappa) of Lemmas 12 and 13."""
    return min(math.pi / 4.0, SIN_8 / kappa) / 6.0
