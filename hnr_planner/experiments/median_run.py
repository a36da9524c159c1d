"""The run of a case with the median number of transitions, to be drawn in a figure."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hnr_planner.core.planning.result import SearchResult
from hnr_planner.drawing import draw_ends, draw_map, draw_sample_cells, draw_title, FAINT_INK, GOAL
from hnr_planner.experiments.results import Results
from hnr_planner.maps import Corridor
from matplotlib.axes import Axes
from matplotlib.patches import Circle
import numpy as np

#: Side of the squares that samples are drawn as [m].
DOT = 0.05


def median_run(
    results: Results, case: Any, search: Callable[[Any, int], SearchResult]
) -> SearchResult:
    """Repeat the search of a case with the seed of the run of median transitions; return it."""
    runs = results.of(case)
    middle = np.argsort(runs['transitions'], kind='stable')[len(runs) // 2]
    return search(case, int(runs['seed'][middle]))


def draw_run(axes: Axes, corridor: Corridor, run: SearchResult, name: str) -> None:
    """Draw the map of a corridor, the samples of a run, start, goal and the goal region."""
    draw_map(axes, corridor.occupancy)
    for image in axes.images:
        image.set_interpolation('none')  # the cells themselves: sharp at any size, few bytes
    draw_sample_cells(axes, run.samples, DOT)
    axes.add_patch(Circle(corridor.goal, corridor.goal_radius, fill=False, edgecolor=GOAL))
    draw_ends(axes, corridor.start, corridor.goal)
    draw_title(axes, f'{name}: median run, {run.iterations:,} transitions')
    axes.set_xlabel('x [m]; samples from the first (light) to the last (dark)', color=FAINT_INK)
