"""The bounds: units, order, and comparison with measured sets."""

import math
from test.core.theory.sets import DISC
from test.sweeps import sweep

from hnr_planner.core import BallSpace, BoxSpace, RequestError, ShearedSpace
from hnr_planner.core.theory import (
    ball_image,
    BallImage,
    best_cut,
    cell_flow,
    chain_distance,
    corrected_conductance,
    cross_ratio_distance,
    image_boundary,
    lipschitz_factor,
    mended_conductance,
    mended_view_bound,
    mixing_bound,
    polygon_area,
    printed_conductance,
    step_length,
    step_overlap,
    unseen_probability,
    variation_bound,
    view_bound,
)
import numpy as np
import pytest
from scipy.spatial.distance import pdist

RADIUS = math.pi**-0.5
#: A disc of area 1 under the shear y + 2 x^2.
BANANA = ShearedSpace(BallSpace((0.0, 0.0), RADIUS), 2.0)


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


@pytest.mark.parametrize('bend', [0.0, 1.0, 2.0])
def test_mending_costs_and_bending_costs(bend):
    image = ball_image(ShearedSpace(BallSpace((0, 0), RADIUS), bend))
    assert 0 < mended_conductance(image) < corrected_conductance(image)
    straight = BallImage.unit_ball(2)
    assert mended_conductance(image) <= mended_conductance(straight) * (1 + 1e-6)


def test_a_sheared_disc_is_measured_as_it_is():
    """Area 1; the two ends of the banana are farther apart than the disc is wide."""
    assert polygon_area(image_boundary(BANANA, 4000)) == pytest.approx(1, rel=1e-5)
    image = ball_image(BANANA)
    assert (image.stretch, image.shrink) == (BANANA.stretch, BANANA.shrink)
    rng = np.random.default_rng(1)
    points = BANANA.image(BANANA.base.centre + RADIUS * unit(rng.normal(size=(2000, 2))))
    assert 0.999 * image.diameter < pdist(points).max() <= image.diameter * (1 + 1e-5)
    # At the tips (x, y) = (+-r, 2 r^2) it turns about as sharply as L^3 times the circle.
    assert image.kappa == pytest.approx(104.044, rel=1e-4)


def unit(u):
    return u / np.linalg.norm(u, axis=1, keepdims=True)


def test_what_has_no_curvature_is_refused():
    with pytest.raises(RequestError, match='not for a BoxSpace in 2 dimensions'):
        ball_image(ShearedSpace(BoxSpace((0, 0), (1, 1)), 1.0))
    with pytest.raises(RequestError, match='not for a BallSpace in 3 dimensions'):
        ball_image(ShearedSpace(BallSpace((0, 0, 0), 1.0), 1.0))


def test_the_bounds_hold_on_a_set_that_is_not_convex():
    """The measured cut of the banana exceeds every version of Lemma 13 by ten magnitudes."""
    image = ball_image(BANANA)
    cut = best_cut(cell_flow(BANANA, (12, 12), 1 << 16)).conductance
    assert cut > 0.1
    assert printed_conductance(image) < 1e-12
    assert mended_conductance(image) < corrected_conductance(image) < 1e-13


@pytest.mark.parametrize('apart', [sweep(0.02), 0.08])
def test_lemma_11_on_a_set_that_is_not_convex(apart):
    """Neighbouring points of the banana; and two in its arms, whose views differ."""
    u = BANANA.image((-0.3, -0.1))
    v = u + (apart, 0.0)
    depth = np.linalg.norm(image_boundary(BANANA, 4000) - u, axis=1).min() - apart
    assert depth > 0.05
    missed = unseen_probability(BANANA, u, v)
    assert missed <= view_bound(ball_image(BANANA).kappa, apart, depth)
    assert unseen_probability(BANANA, BANANA.image((-0.4, 0.1)), BANANA.image((0.4, 0.1))) > 0.01


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
    """Lemma 6 as printed: sqrt(M) (1 - Phi^2 / 2)^t reaches epsilon at t."""
    t = mixing_bound(0.1, 4.0, 0.01)
    assert math.sqrt(4) * (1 - 0.1**2 / 2) ** t == pytest.approx(0.01)
    assert mixing_bound(0.1, math.inf, 0.01) == math.inf
    assert mixing_bound(1e-12, 4.0, 0.01) == pytest.approx(2e24 * math.log(200), rel=1e-3)


def test_the_factor_of_lemma_10_does_not_depend_on_the_size():
    for radius in (0.3, 2.0):
        image = BallImage(3, radius, 2 * radius)
        assert image.ratio_bound == pytest.approx(BallImage.unit_ball(3).ratio_bound)
