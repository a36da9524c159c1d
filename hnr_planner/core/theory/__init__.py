"""
Quantities of the paper, computed: the distribution of a step, the shape of sets, mixing.

Source: Abbasi-Yadkori, Bartlett, Gabillon and Malek, "Hit-and-Run for Sampling and Planning in
Non-Convex Spaces" (2016). Sigma is the set, n its dimension. Lemmas and equations are numbered as
in the arXiv text: Lemmas 8 to 10 on cross-ratios, 11 on views, 12 on total variation, 13 on
conductance, Theorem 5 on mixing. ``docs/theory.md`` has values on example sets, and the errors of
the paper.

========================  =============================================================
module                    quantity
========================  =============================================================
``density``               transition density f_u of a step (equation (2))
``step``                  step probability P_u(A), step length F(u), overlap of two steps
``view``                  the points visible from a point (Section 3.1)
``cross_ratio``           cross-ratio distance d_Sigma (Definition 1)
``chain_distance``        chain distance d-tilde (Definition 2)
``links``                 link diameter tau (Definition 2)
``curvature``             curvature kappa (Assumption 3)
``boundary_ratio``        boundary ratio R_epsilon (Definition 3)
``conductance``           conductance Phi (Section 3.1)
``bounds``                the bounds on Phi and on the mixing time (Lemmas 6 to 13)
``embedding``             what the bounds need of the image of a disc (Assumption 2)
``isoperimetry``          both sides of the isoperimetric inequality (Theorem 7)
``star_shaped``           kernel and image of star-shaped sets, and what they bound (Section 1)
``path_length``           transitions of a walk into a goal (Section 1)
``rays``, ``corners``     quadrature over directions, and kinks of the boundary
========================  =============================================================

>>> disc = BallSpace((0, 0), 1)
>>> cross_ratio_distance(disc, (-0.5, 0), (0.5, 0))
array([8.])
"""

from hnr_planner.core.theory.boundary_ratio import ball_boundary_ratio, boundary_ratio
from hnr_planner.core.theory.bounds import (
    BallImage,
    corrected_conductance,
    lipschitz_factor,
    mended_conductance,
    mended_view_bound,
    mixing_bound,
    printed_conductance,
    ratio_inequality,
    variation_bound,
    view_bound,
)
from hnr_planner.core.theory.chain_distance import Bounds, chain_distance, even_chain_distance
from hnr_planner.core.theory.conductance import (
    best_cut,
    cell_flow,
    CellFlow,
    Cut,
    cut_conductance,
    Estimate,
)
from hnr_planner.core.theory.cross_ratio import cross_ratio_distance, hilbert_distance
from hnr_planner.core.theory.curvature import Curvature, curve_curvature, slice_curvature
from hnr_planner.core.theory.density import log_ball_volume, transition_density
from hnr_planner.core.theory.embedding import ball_image, image_boundary
from hnr_planner.core.theory.isoperimetry import Isoperimetry, isoperimetry
from hnr_planner.core.theory.links import (
    annulus_sector_links,
    link_diameter,
    LinkBounds,
    polygon_link_diameter,
)
from hnr_planner.core.theory.path_length import (
    expected_transitions,
    mixing_estimate,
    mixing_time,
    transitions_bound,
)
from hnr_planner.core.theory.star_shaped import (
    ball_walk_conductance,
    star_boundary,
    star_image,
    star_isoperimetry,
    star_kernel,
)
from hnr_planner.core.theory.step import (
    step_length,
    step_mean,
    step_overlap,
    step_probability,
    unseen_probability,
)
from hnr_planner.core.theory.view import polygon_area, view

__all__ = [
    'BallImage',
    'Bounds',
    'CellFlow',
    'Curvature',
    'Cut',
    'Estimate',
    'Isoperimetry',
    'LinkBounds',
    'annulus_sector_links',
    'ball_boundary_ratio',
    'ball_image',
    'ball_walk_conductance',
    'best_cut',
    'boundary_ratio',
    'cell_flow',
    'chain_distance',
    'corrected_conductance',
    'cross_ratio_distance',
    'curve_curvature',
    'cut_conductance',
    'even_chain_distance',
    'expected_transitions',
    'hilbert_distance',
    'image_boundary',
    'isoperimetry',
    'link_diameter',
    'lipschitz_factor',
    'log_ball_volume',
    'mended_conductance',
    'mended_view_bound',
    'mixing_bound',
    'mixing_estimate',
    'mixing_time',
    'polygon_area',
    'polygon_link_diameter',
    'printed_conductance',
    'ratio_inequality',
    'slice_curvature',
    'star_boundary',
    'star_image',
    'star_isoperimetry',
    'star_kernel',
    'step_length',
    'step_mean',
    'step_overlap',
    'step_probability',
    'transition_density',
    'transitions_bound',
    'unseen_probability',
    'variation_bound',
    'view',
    'view_bound',
]
