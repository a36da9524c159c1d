"""Laws of star-shaped sets: kernels by sight, the map of a disc, bounds that hold."""

import math
from test.core.theory.stars import lobes, SMOOTH, WALKED

from hnr_planner.core import RequestError
from hnr_planner.core.theory import (
    ball_walk_conductance,
    BallImage,
    log_ball_volume,
    star_boundary,
    star_image,
    star_isoperimetry,
    star_kernel,
)
import numpy as np
import pytest
import shapely

L, _ = WALKED['L']
STAR, _ = WALKED['star']
U = shapely.box(0, 0, 3, 3) - shapely.box(1, 1, 2, 4)


def test_kernels_by_hand():
    assert star_kernel(L).equals(shapely.box(0, 0, 1, 1))
    assert star_kernel(U).is_empty
    square = shapely.box(0, 0, 1, 1)
    assert star_kernel(square).equals(square)
    assert star_kernel(square.reverse()).equals(square)
    assert star_kernel(square - shapely.box(0.4, 0.4, 0.6, 0.6)).is_empty


@pytest.mark.parametrize('polygon', [L, STAR], ids=['L', 'star'])
def test_a_point_is_in_the_kernel_when_it_sees_every_corner(polygon):
    """A polygon is visible from a point as soon as its corners are."""
    corners = shapely.get_coordinates(polygon.exterior)
    drawn = np.random.default_rng(1).uniform(*np.reshape(polygon.bounds, (2, 2)), (400, 2))
    points = [point for point in shapely.points(drawn) if polygon.contains(point)]
    around = polygon.buffer(1e-9)
    sees = [
        all(around.covers(shapely.LineString([(p.x, p.y), corner])) for corner in corners)
        for p in points
    ]
    kernel = star_kernel(polygon)
    assert sees == [kernel.contains(point) for point in points]
    assert 10 < sum(sees) < len(points) - 10


def mapped(radii, points):
    """Map points (k, 2) of the disc of equal area as ``star_image`` says, step by step."""
    rho = np.append(radii, radii[0])
    phi = np.linspace(0.0, 2.0 * math.pi, len(rho))
    area = np.concatenate([[0.0], np.cumsum((rho[1:] ** 2 + rho[:-1] ** 2) / 4.0 * phi[1])])
    radius = math.sqrt(area[-1] / math.pi)
    s, theta = np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0]) % (2.0 * math.pi)
    there = np.interp(theta * radius**2 / 2.0, area, phi)
    length = s * np.interp(there, phi, rho) / radius
    return np.stack([length * np.cos(there), length * np.sin(there)], axis=1)


@pytest.mark.parametrize('name', SMOOTH)
def test_the_map_keeps_areas_and_its_constants_are_the_largest_stretches(name):
    image = star_image(SMOOTH[name])
    rng = np.random.default_rng(2)
    points = rng.normal(size=(20_000, 2))
    points *= (image.radius * np.sqrt(rng.random(20_000)) / np.hypot(*points.T))[:, None]
    step = 1e-4
    columns = [
        (mapped(SMOOTH[name], points + move) - mapped(SMOOTH[name], points - move)) / (2 * step)
        for move in ((step, 0.0), (0.0, step))
    ]
    derivative = np.stack(columns, axis=2)[np.hypot(*points.T) > 0.05]
    assert np.linalg.det(derivative) == pytest.approx(1.0, abs=0.02)
    values = np.linalg.svd(derivative, compute_uv=False)
    assert values[:, 0].max() == pytest.approx(image.stretch, rel=0.01)
    assert 1.0 / values[:, 1].min() == pytest.approx(image.shrink, rel=0.01)


def test_a_disc_is_mapped_to_itself():
    image = star_image(np.full(64, 2.0))
    expected = BallImage(2, 2.0, 4.0)
    assert (image.radius, image.stretch, image.shrink) == pytest.approx((2.0, 1.0, 1.0))
    assert (image.diameter, image.kappa) == pytest.approx((expected.diameter, expected.kappa))


@pytest.mark.parametrize('radii', [np.ones(7), [1.0] * 7 + [0.0], [1.0] * 8 + [math.nan]])
def test_bad_radii_are_refused(radii):
    with pytest.raises(RequestError, match='radii must be at least 8 positive numbers'):
        star_image(radii)


@pytest.mark.parametrize('name', ['stretch', 'shrink'])
def test_constants_below_one_are_refused(name):
    """Equation (1)."""
    with pytest.raises(
        RequestError, match=rf'{name} must be at least 1 \(equation \(1\)\), got 0'
    ):
        BallImage(2, 1.0, 2.0, **{name: 0.99})
    assert all(star_image(radii).stretch > 1.0 for radii in SMOOTH.values())


def test_a_unit_ball_in_a_set_of_volume_one_needs_thirteen_dimensions():
    """Assumption 4."""
    fits = [n for n in range(1, 30) if math.exp(log_ball_volume(n)) <= 1.0]
    assert fits == list(range(13, 30))
    assert all((BallImage.unit_ball(n).radius >= 1.0) == (n in fits) for n in range(1, 30))


@pytest.mark.parametrize('polygon', [L, STAR], ids=['L', 'star'])
def test_strips_are_as_large_as_the_isoperimetric_inequality_says(polygon):
    """Also far from tight; a psi 100 times as large fails."""
    corners = shapely.get_coordinates(polygon.exterior)
    diameter = max(np.linalg.norm(a - b) for a in corners for b in corners)
    psi = star_isoperimetry(star_kernel(polygon).area / polygon.area, diameter)
    slack = []
    for angle in np.linspace(0.0, math.pi, 12, endpoint=False):
        turned = shapely.affinity.rotate(polygon, angle, origin=(0, 0), use_radians=True)
        left, bottom, right, top = turned.bounds
        for at in np.linspace(left, right, 10)[1:-1]:
            width = 0.01 * (right - left)
            parts = (
                (left, at - width / 2),
                (at + width / 2, right),
                (at - width / 2, at + width / 2),
            )
            first, second, third = (
                turned.intersection(shapely.box(begin, bottom, end, top)).area
                for begin, end in parts
            )
            slack.append(third / (psi * width * min(first, second)))
    assert 1.0 < min(slack) < 100.0


def test_the_bound_is_below_the_flow_of_a_ball_walk():
    """A cut through the corner of the L, by 200 000 steps from uniform points; z > 5."""
    radius, rng = 0.6, np.random.default_rng(3)

    def inside(points):
        return ((points > 0) & (points < 2)).all(axis=1) & ~(points > 1).all(axis=1)

    points = rng.uniform(0.0, 2.0, (400_000, 2))
    points = points[inside(points)]
    steps = rng.normal(size=points.shape)
    steps *= (radius * np.sqrt(rng.random(len(points))) / np.hypot(*steps.T))[:, None]
    crosses = inside(points + steps) & (
        (points[:, 0] > points[:, 1]) != ((points + steps)[:, 0] > (points + steps)[:, 1])
    )
    bound = ball_walk_conductance(star_isoperimetry(1.0 / 3.0, math.sqrt(8.0)), radius, 0.25)
    error = math.sqrt(crosses.mean() / len(crosses))
    assert crosses.mean() - 5.0 * error > bound > 0.0


def test_more_acceptance_and_a_larger_kernel_bound_more():
    low, high = star_isoperimetry(0.1, 2.0), star_isoperimetry(0.9, 2.0)
    assert low < high
    assert ball_walk_conductance(low, 0.1, 0.5) < ball_walk_conductance(high, 0.1, 0.5)
    assert ball_walk_conductance(1e9, 1.0, 0.4) == 0.05
    with pytest.raises(RequestError, match='fraction'):
        star_isoperimetry(0.0, 1.0)
    assert np.hypot(*star_boundary(lobes(0.2, 3)).T) == pytest.approx(lobes(0.2, 3))
