"""
Several ways around
===================

Up to four paths of which none can be deformed into another past an obstacle; the shortest first.
"""

from hnr_planner import GridSpace, plan
from hnr_planner.drawing import draw_ends, draw_map, draw_path
from hnr_planner.maps import OccupancyMap
from matplotlib import pyplot as plt
import numpy as np

cells = np.zeros((50, 80), np.int8)
for row, column in ((4, 14), (30, 18), (16, 34), (2, 52), (32, 54)):
    cells[row:, column:][:14, :12] = 100
yard = OccupancyMap(cells, 0.1)
space = GridSpace.from_occupancy(yard.data, yard.resolution, robot_radius=0.3)
start, goal = (0.6, 2.2), (7.4, 2.8)
result = plan(space, start, goal, alternatives=4, seed=2, time_limit=120)
print(result.message)

figure, axes = plt.subplots(figsize=(7.5, 4.8))
draw_map(axes, yard, space.blocked)
for colour, path in zip(('#D55E00', '#0072B2', '#009E73', '#CC79A7'), result.paths, strict=False):
    draw_path(axes, path, colour=colour)
draw_ends(axes, start, goal)
axes.set_title(f'{len(result.paths)} ways for a robot of 0.3 m')
plt.show()
