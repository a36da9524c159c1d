"""The bounds: units, order, and what they say of sets that can be measured."""

import math
from test.core.theory.sets import DISC

from hnr_planner.core import BallSpace
from hnr_planner.core.theory import (
    BallImage,
    chain_distance,
    corrected_conductance,
    cross_ratio_distance,
    disc_image,
    image_boundary,
    lipschitz_factor,
    mended_conductance,
    mended_view_bound,
    mixing_bound,
    polygon_area,
    printed_conductance,
    shear_stretch,
    step_length,
    step_overlap,
    variation_bound,
    view_bound,
)
import numpy as np
import pytest
from scipy.spatial.distance import pdist

RADIUS = math.pi**-0.5


def bend(strength):
    """Return the shear (x, y + strength x^2), and how steep it is on the disc of area 1."""
    return (
        lambda points: np.stack([points[:, 0], points[:, 1] + strength * points[:, 0] ** 2], 1),
        2 * strength * RADIUS,
    )


@pytest.mark.parametrize('dim', [2, 3, 12, 200])
def test_the_unit_ball_has_volume_one(dim):
    image = BallImage.unit_ball(dim)
    log_volume = dim * math.log(image.radius * math.sqrt(math.pi)) - math.lgamma(dim / 2 + 1)
    assert log_volume == pytest.approx(0, abs=1e-9)
    assert image.diameter == 2 * image.radius


@pytest.mark.parametrize('bound', [corrected_conductance, mended_conductance])
@pytest.mark.parametrize('dim', [2, 3, 50])
def test_a_bound_without_unit_does_not_change_with_the_unit(bound, dim):
    metres = BallImage.unit_ball(dim)
    feet = BallImage(dim, metres.radius * 3.28, metres.diameter * 3.28)
    assert bound(feet) == pytest.approx(bound(metres), rel=1e-9, abs=0)
    assert printed_conductance(feet) != pytest.approx(printed_conductance(metres), abs=0)


@pytest.mark.parametrize('strength', [0.0, 1.0, 2.0])
def test_mending_costs_and_bending_costs(strength):
    mapping, slope = bend(strength)
    stretch = shear_stretch(slope)
    image = disc_image(RADIUS, mapping, stretch, stretch)
    assert 0 < mended_conductance(image) < corrected_conductance(image)
    straight = BallImage.unit_ball(2)
    assert mended_conductance(image) <= mended_conductance(straight) * (1 + 1e-6)


@pytest.mark.parametrize('strength', [0.5, 2.0])
def test_a_shear_stretches_no_more_than_it_says_and_nearly_as_much(strength):
    mapping, slope = bend(strength)
    points = image_boundary(RADIUS, lambda circle: circle, 800)
    apart, moved = pdist(points), pdist(mapping(points))
    assert polygon_area(image_boundary(RADIUS, mapping, 4000)) == pytest.approx(1, rel=1e-5)
    assert (moved / apart).max() <= shear_stretch(slope)
    assert (apart / moved).max() <= shear_stretch(slope)
    steep = np.array([(RADIUS, 0.0), (RADIUS, 1e-6)])
    steep[1] += np.array([1e-6, 0.0]) * (shear_stretch(slope) - 1e-9)
    assert shear_stretch(0) == 1
    matrix = np.array([[1, 0], [slope, 1]])
    assert np.linalg.norm(matrix, 2) == pytest.approx(shear_stretch(slope))
    assert np.linalg.norm(np.linalg.inv(matrix), 2) == pytest.approx(shear_stretch(slope))


def test_lemma_10_on_the_disc():
    """The identity: d-tilde is below d, and the lemma allows it some thousand times as much."""
    u, v = (-0.5, 0.1), (0.4, 0.3)
    d = cross_ratio_distance(DISC, u, v)[0]
    disc = BallImage(2, 1.0, 2.0)
    assert chain_distance(DISC, u, v, 2).upper <= lipschitz_factor(disc, 0.5) * d


def test_lemma_12_on_the_disc():
    """Points as far apart as the lemma lets them be have nearly the same law: no sharp bound."""
    epsilon, u = 0.5, np.array([0.2, 0.1])
    closest = math.sin(math.pi / 8) / (2 * math.pi) * epsilon / 6
    apart = min(2 * step_length(DISC, u) / math.sqrt(2), closest)
    v = u + (0.9 * apart, 0.0)
    assert cross_ratio_distance(DISC, u, v)[0] < epsilon / 24 / 2
    assert 1 - step_overlap(DISC, u, v) < 0.1 < variation_bound(epsilon, 2.0)


def test_views_are_bounded():
    assert view_bound(2 * math.pi, 0.01, 0.5) == pytest.approx(16.4188 * 0.02, rel=1e-4)
    assert mended_view_bound(2, 7.0, 0.01, 0.5) == pytest.approx(
        math.pi / 2 * view_bound(7.0, 0.01, 0.5)
    )
    assert mended_view_bound(3, 7.0, 0.01, 0.5) > mended_view_bound(2, 7.0, 0.01, 0.5)


def test_mixing_follows_from_conductance():
    """Lemma 6 as it stands: sqrt(M) (1 - Phi^2 / 2)^t reaches epsilon at t."""
    t = mixing_bound(0.1, 4.0, 0.01)
    assert math.sqrt(4) * (1 - 0.1**2 / 2) ** t == pytest.approx(0.01)
    assert mixing_bound(0.1, math.inf, 0.01) == math.inf
    assert mixing_bound(1e-12, 4.0, 0.01) == pytest.approx(2e24 * math.log(200), rel=1e-3)


def test_the_ball_behind_the_bound_is_met_at_every_size():
    """R of Definition 3 in the formula and in balls of other radii."""
    assert BallSpace(np.zeros(3), 2.0).radius == 2.0
    for radius in (0.3, 2.0):
        image = BallImage(3, radius, 2 * radius)
        assert image.ratio_bound == pytest.approx(BallImage.unit_ball(3).ratio_bound)
