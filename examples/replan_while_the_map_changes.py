"""
Plan again while the map changes
================================

Obstacles appear on the path, one after the other; a request on the newest map takes milliseconds.
"""

from hnr_planner import GridSpace, plan
from hnr_planner.drawing import draw_ends, draw_map, draw_path
from hnr_planner.maps import OccupancyMap
from matplotlib import pyplot as plt
import numpy as np

cells = np.zeros((30, 50), np.int8)
cells[8:22, 12:15] = cells[4:18, 26:29] = 100
space = GridSpace.from_occupancy(cells, 0.2)
start, goal = (0.5, 3.0), (9.5, 3.0)

figure, panels = plt.subplots(1, 3, figsize=(13, 3))
for axes in panels:
    result = plan(space, start, goal, optimize_for=0.5, seed=1, time_limit=60)
    print(result.message)
    draw_map(axes, OccupancyMap(cells, 0.2))
    draw_path(axes, result.path)
    draw_ends(axes, start, goal)
    axes.set_title(f'{result.length:.2f} m')
    # A pallet is put down in the middle of the way.
    cells = cells.copy()
    row, column = (result.path[len(result.path) // 2] / 0.2).astype(int)[::-1]
    top, left = max(row - 4, 0), column + 2
    cells[top:, left:][:8, :4] = 100
    space = GridSpace.from_occupancy(cells, 0.2)
plt.show()
