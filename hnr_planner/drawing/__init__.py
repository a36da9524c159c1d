"""
Draw maps, samples and paths.

Every ``draw_*`` function draws one thing on matplotlib axes in metres of the map frame;
``figure_of_plans`` and ``figure_of_samples`` make whole figures. Figures are made without
pyplot, so nothing global is touched and no display is needed.
"""

from hnr_planner.drawing.figures import figure_of_plans, figure_of_samples, Plan, save
from hnr_planner.drawing.maps import cell_kinds, draw_map, kinds_present, known_box
from hnr_planner.drawing.searches import (
    draw_ends,
    draw_footprints,
    draw_path,
    draw_sample_cells,
    draw_samples,
    draw_tree,
)
from hnr_planner.drawing.style import (
    AGES,
    draw_title,
    FAINT_INK,
    FRAME,
    GOAL,
    INK,
    KINDS,
    PATH,
    START,
)

__all__ = [
    'AGES',
    'FAINT_INK',
    'FRAME',
    'GOAL',
    'INK',
    'KINDS',
    'PATH',
    'START',
    'Plan',
    'cell_kinds',
    'draw_ends',
    'draw_footprints',
    'draw_map',
    'draw_path',
    'draw_sample_cells',
    'draw_samples',
    'draw_title',
    'draw_tree',
    'figure_of_plans',
    'figure_of_samples',
    'kinds_present',
    'known_box',
    'save',
]
