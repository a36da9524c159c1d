"""
Errors of the paper: the printed values and our values, one function for each statement.

Each returns numbers by name; ``test_paper.py`` says what must hold of them, and
``test_page.py`` that ``docs/theory.md`` prints them.
"""

from fractions import Fraction
from functools import cache
import math
from test.core.theory.sets import DISC, HALF_DISCS, L_SET, PLUS

from hnr_planner.core import BallSpace, PolytopeSpace
from hnr_planner.core.theory import (
    BallImage,
    chain_distance,
    corrected_conductance,
    cross_ratio_distance,
    curve_curvature,
    printed_conductance,
    repaired_conductance,
    repaired_view_bound,
    step_length,
    step_probability,
    view_bound,
)
from hnr_planner.core.theory.rays import chords, half_sphere
import numpy as np
from scipy.spatial import ConvexHull
from scipy.special import betainc

DIMENSIONS = (2, 3, 10, 100, 10_000)
N_WALKS = 4_000_000


@cache
def first_branch():
    """Return d of points epsilon/10 apart about the middle of a ball, and both bounds on it."""
    found = {}
    for dim in (2, 3, 10):
        image = BallImage.unit_ball(dim)
        ball = BallSpace(np.zeros(dim), image.radius)
        u = np.zeros(dim)
        u[0] = image.radius / (2 * dim) / 10 / 2
        found[f'd, n = {dim}'] = cross_ratio_distance(ball, -u, u)[0]
        found[f'printed, n = {dim}'] = 2 / (5 * dim * image.diameter)
        found[f'corrected, n = {dim}'] = image.radius / (5 * dim * image.diameter)
    return found


@cache
def third_branch():
    """Return d / epsilon'' on the long axis of an ellipse of area 1, 16 times as long as wide."""
    factor, radius = 4.0, math.pi**-0.5
    a, b = factor * radius, radius / factor
    angle = np.arange(4096) * (2 * math.pi / 4096)
    kappa = curve_curvature(np.stack([a * np.cos(angle), b * np.sin(angle)], axis=1)).kappa
    image = BallImage(2, radius, 2 * a, factor, factor, kappa)
    closeness = math.sin(math.pi / 8) / kappa / 6
    apart = closeness * image.depth
    d = image.diameter * apart / ((image.diameter - apart) / 2) ** 2
    near = min(1 / (8 * math.sqrt(2)), closeness)
    return {
        'd': d / image.depth,
        'printed': 2 / math.sqrt(2) * near,
        'corrected': 4 / image.diameter * near,
    }


@cache
def prefactor():
    """Return the factors that the proof of Lemma 13 loses, one by one, and their product."""
    return {
        'delta / 2 of Case 2': Fraction(1, 2),
        'from Omega to Omega^epsilon': Fraction(1, 2),
        'from Sigma_i to S_i': Fraction(1, 2),
        'h = d / 3': Fraction(1, 3),
    }


@cache
def rate_on_the_ball():
    """Return the three versions of Lemma 13 on the ball of volume 1, and their slopes in log n."""
    found = {}
    for name, bound in (
        ('printed', printed_conductance),
        ('corrected', corrected_conductance),
        ('repaired', repaired_conductance),
    ):
        for dim in DIMENSIONS:
            here, there = (bound(BallImage.unit_ball(n)) for n in (dim, 2 * dim))
            found[f'{name}, n = {dim}'] = here
            found[f'slope {name}, n = {dim}'] = math.log2(there / here)
    return found


def beyond_cap(dim, height):
    """Return the probability that a uniform direction has |u_1| > height."""
    return 1 - betainc(0.5, (dim - 1) / 2, min(1.0, height**2))


def too_near(space, u):
    """Return P_u(A_3): a step of less than a sixth of the way to an end of its chord."""
    directions, weights = half_sphere(np.asarray(u, float), 4000, space)
    behind, ahead = chords(space, np.asarray(u, float), directions)
    sixth = np.maximum(behind, ahead) / 6
    near = np.minimum(behind, sixth) + np.minimum(ahead, sixth)
    return float(weights @ (near / (behind + ahead)))


@cache
def cap():
    """Return P(A_2) and P(A_3) of Lemma 12's proof, where it says that both are at most 1/6."""
    found = {}
    for dim in DIMENSIONS:
        found[f'P(A_2), n = {dim}'] = beyond_cap(dim, 1 / math.sqrt(dim))
        found[f'P(A_2) cut at 2 / sqrt n, n = {dim}'] = beyond_cap(dim, 2 / math.sqrt(dim))
    found['P(A_3), middle of a disc'] = too_near(DISC, (0, 0))
    found['P(A_3), disc, .75 from the middle'] = too_near(DISC, (0.75, 0))
    found['P(A_3), half discs of 6 and 1'] = too_near(HALF_DISCS, (0, 0))
    found['sum, n = 2'] = 1 / 8 + found['P(A_2), n = 2'] + 2 / 7 + 1 / 6
    found['sum cut at 2 / sqrt n'] = (
        1 / 8 + beyond_cap(10**9, 2 / math.sqrt(10**9)) + 2 / 7 + 1 / 6
    )
    return found


@cache
def detours():
    """Return d and d-tilde of mutually visible points, in the disc and in the plus."""
    ends = (-0.5, 0), (0.5, 0)
    amid = (3.4, 3.4), (3.6, 3.6)
    return {
        'd, disc': cross_ratio_distance(DISC, *ends)[0],
        '2 links, disc': chain_distance(DISC, *ends, 2).upper,
        '3 links, disc': chain_distance(DISC, *ends, 3).upper,
        'limit, disc': chain_distance(DISC, *ends).upper,
        'd, plus': cross_ratio_distance(PLUS, *amid)[0],
        '2 links, plus': chain_distance(PLUS, *amid, 2).upper,
        'limit, plus': chain_distance(PLUS, *amid).upper,
    }


def saddle_slice(height, bend=1.0, n_points=1 << 14):
    """
    Return a part of the slice of the unit ball, sheared by z + bend x^2, at z = 1 + height.

    y^2 = 1 - x^2 - (z - bend x^2)^2, a quadratic in x^2 with zeros low and high, of which the part
    with x > 0 lies between the roots.
    """
    z = 1 + height
    across = math.sqrt((2 * z * bend - 1) ** 2 + 4 * bend**2 * (1 - z**2))
    low, high = (math.sqrt((2 * z * bend - 1 + s * across) / (2 * bend**2)) for s in (-1, 1))
    angle = np.arange(n_points) * (2 * math.pi / n_points)
    x = (low + high) / 2 - (high - low) / 2 * np.cos(angle)
    y = bend * (high - low) / 2 * np.sin(angle) * np.sqrt((x + low) * (high + x))
    return np.stack([x, y], axis=1)


@cache
def saddle():
    """Return kappa of slices of a sheared ball nearer and nearer to its saddle point."""
    heights = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
    return {f'kappa, h = {h:g}': curve_curvature(saddle_slice(h)).kappa for h in heights}


@cache
def idle_terms():
    """Return the terms of Lemmas 11 to 13 that never bind, and those that do."""
    return {
        'sin(pi/8) / kappa at most': math.sin(math.pi / 8) / (2 * math.pi),
        'pi / 4': math.pi / 4,
        'kappa / sin(pi/8) at least': 2 * math.pi / math.sin(math.pi / 8),
        '4 / pi': 4 / math.pi,
    }


@cache
def short_steps():
    """Return F(u) by the distance h to the boundary, in the disc."""
    return {
        f'F / h, disc, {r:g} from the middle': step_length(DISC, (r, 0)) / (1 - r)
        for r in (0.0, 0.5, 0.9)
    }


@cache
def hull():
    """Return both sides of (9) for three points of an L, and of an L twice as large."""
    found = {}
    for scale in (1.0, 2.0):
        corners, sides = scale * np.array([(0.5, 0.5), (1.2, 0.4), (0.4, 1.2)]), []
        ell = type(L_SET).from_blocked(L_SET.blocked, scale)
        for i, j in ((0, 1), (0, 2), (1, 2)):
            away = corners[j] - corners[i]
            away /= np.linalg.norm(away)
            behind, ahead = (end[0] for end in chords(ell, corners[i], away))
            sides += [corners[i] - behind * away, corners[i] + ahead * away]
        planes = ConvexHull(np.array(sides)).equations
        cell = PolytopeSpace(planes[:, :2], -planes[:, 2])
        u, v = corners[0], corners[1]
        direction = (v - u) / np.linalg.norm(v - u)
        behind, ahead = (end[0] for end in chords(cell, u, direction))
        depth, diameter = 0.5 * scale, math.hypot(2, 2) * scale
        found[f'l_C, size {scale:g}'] = behind + ahead
        found[f'd_C, size {scale:g}'] = cross_ratio_distance(cell, u, v)[0]
        found[f'bound, size {scale:g}'] = diameter / depth * cross_ratio_distance(ell, u, v)[0]
    return found


@cache
def warmth():
    """
    Return the probability of a small ball around the start, by its volume, after k steps.

    From the middle of the unit ball; one and two steps by quadrature, later ones from N_WALKS
    walks drawn by their distance from the middle.
    """
    found = {}
    for dim in (2, 3):
        ball = BallSpace(np.zeros(dim), 1.0)
        for s in (0.1, 0.01, 0.001):
            small = BallSpace(np.zeros(dim), s)
            found[f'n = {dim}, k = 1, s = {s:g}'] = s / s**dim
            # After one step the distance from the middle is uniform.
            total = 0.0
            for first, last in ((0.0, s), (s, 2 * s), (2 * s, 10 * s), (10 * s, 1.0)):
                nodes, weights = np.polynomial.legendre.leggauss(12)
                for node, weight in zip(nodes, weights, strict=True):
                    radius = (first + last) / 2 + (last - first) / 2 * node
                    u = np.zeros(dim)
                    u[0] = radius
                    p = hits(dim, radius, s) if radius > s else step_probability(ball, u, small)
                    total += p * weight * (last - first) / 2
            found[f'n = {dim}, k = 2, s = {s:g}'] = total / s**dim
    for dim in (2, 3):
        for k, radii in enumerate(radial_walk(dim, N_WALKS, n_steps=4, seed=1), start=1):
            for s in (0.4, 0.1):
                found[f'n = {dim}, k = {k}, s = {s:g}, drawn'] = (radii < s).mean() / s**dim
    return found


def radial_walk(dim, n_walks, n_steps, seed):
    """Yield the distances (n_walks,) from the middle of the unit ball after every step."""
    rng = np.random.default_rng(seed)
    radius = np.zeros(n_walks)
    for _ in range(n_steps):
        if dim == 2:
            cosine = np.cos(2 * math.pi * rng.random(n_walks))
        else:
            cosine = rng.uniform(-1, 1, n_walks)
        along = radius * cosine
        half = np.sqrt(1 - radius**2 + along**2)
        s = rng.uniform(-along - half, -along + half)
        radius = np.sqrt(np.maximum(radius**2 + s * (s + 2 * along), 0))
        yield radius


def hits(dim, radius, small):
    """Return the probability of a step from ``radius`` into the ball of radius ``small``."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    widest = math.asin(small / radius)
    # sin(angle) = small / radius sin(t) takes the root out of the chord in the small ball.
    t = math.pi / 4 * (nodes + 1)
    sine = np.sin(widest) * np.sin(t)
    inner = 2 * small * np.cos(t)
    outer = 2 * np.sqrt(1 - (radius * sine) ** 2)
    angle_per_t = np.sin(widest) * np.cos(t) / np.sqrt(1 - sine**2)
    density = 2 / math.pi if dim == 2 else sine
    return float(weights * math.pi / 4 @ (inner / outer * density * angle_per_t))


@cache
def plane_angles():
    """Return the factor that Lemma 11 loses: sines for angles, uniform angles in a plane."""
    return {
        f'loss, n = {dim}': repaired_view_bound(dim, 10.0, 0.1, 1.0) / view_bound(10.0, 0.1, 1.0)
        for dim in DIMENSIONS
    }
