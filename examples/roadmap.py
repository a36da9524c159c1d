"""
Many requests on one map
========================

A roadmap is built once; each request then gets its shortest path without a search.
"""

from hnr_planner import GridSpace, plan, Roadmap
from hnr_planner.drawing import draw_map, draw_path
from hnr_planner.maps import OccupancyMap
from matplotlib import pyplot as plt
import numpy as np

rng = np.random.default_rng(4)
cells = np.zeros((40, 60), np.int8)
for row, column in rng.integers((2, 2), (34, 54), (14, 2)):
    cells[row:, column:][:4, :3] = 100
yard = OccupancyMap(cells, 0.25)
space = GridSpace.from_occupancy(yard.data, yard.resolution)
roadmap = Roadmap.build(space, seed=1)
print(roadmap)

figure, axes = plt.subplots(figsize=(7.5, 5))
draw_map(axes, yard)
depot = (0.4, 0.4)
for goal in rng.uniform((1, 1), (14.5, 9.5), (25, 2)):
    result = plan(space, depot, goal, algorithm=roadmap, time_limit=60)
    if result.status.name == 'SOLVED':
        draw_path(axes, result.path)
axes.set_title('25 requests from one corner')
plt.show()
