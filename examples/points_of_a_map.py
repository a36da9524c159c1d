"""
Uniform points of a map
=======================

Points that are uniform on all free space, with the connected component of each.
"""

from hnr_planner import GridSpace, sample_free_space
from hnr_planner.drawing import draw_map
from hnr_planner.maps import OccupancyMap
from matplotlib import pyplot as plt
import numpy as np

cells = np.zeros((40, 60), np.int8)
cells[:, 39:41] = 100  # a wall without a door: two components
cells[10:30, 12:24] = 100
floor = OccupancyMap(cells, 0.1)
space = GridSpace.from_occupancy(floor.data, floor.resolution)
draws = sample_free_space(space, 1500, thin=2, seed=1)
print('points in each component:', np.unique(draws.components, return_counts=True)[1])

figure, axes = plt.subplots(figsize=(7, 4.8))
draw_map(axes, floor)
axes.scatter(*draws.points[0].T, c=draws.components[0], s=4, cmap='coolwarm')
axes.set_title('1500 uniform points, in proportion to the areas')
plt.show()
