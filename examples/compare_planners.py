"""
Compare planners
================

The same request through a spiral by the paper's two planners and by their two-tree forms.
"""

from hnr_planner import GridSpace, plan
from hnr_planner.drawing import draw_ends, draw_map, draw_path, draw_samples, draw_tree
from hnr_planner.maps import spiral
from matplotlib import pyplot as plt

corridor = spiral(2.4)
grid = corridor.occupancy
space = GridSpace.from_occupancy(grid.data, grid.resolution, grid.origin)

figure, panels = plt.subplots(1, 4, figsize=(13, 3.6), sharey=True)
for axes, name in zip(
    panels, ('hit_and_run', 'rrt', 'hit_and_run_connect', 'rrt_connect'), strict=True
):
    result = plan(
        space, corridor.start, corridor.goal, algorithm=name, seed=3, time_limit=60, simplify=False
    )
    draw_map(axes, grid)
    draw_tree(axes, result.samples, result.parents)
    draw_samples(axes, result.samples)
    draw_path(axes, result.path)
    draw_ends(axes, corridor.start, corridor.goal)
    axes.set_title(f'{name}\n{result.iterations} transitions, {result.length:.0f} m', fontsize=9)
    axes.set_ylabel('')
figure.tight_layout()
plt.show()
