"""
Keep away from obstacles
========================

With ``clearance`` a path keeps its distance where it can, and passes doors in their middle.
"""

from hnr_planner import GridSpace, plan
from hnr_planner.drawing import draw_ends, draw_map, draw_path
from hnr_planner.maps import OccupancyMap
from matplotlib import pyplot as plt
import numpy as np

cells = np.zeros((60, 100), np.int8)
cells[:35, 30:33] = cells[25:, 62:65] = 100
rooms = OccupancyMap(cells, 0.1)
space = GridSpace.from_occupancy(rooms.data, rooms.resolution)
start, goal = (1.0, 1.0), (9.0, 5.0)

figure, axes = plt.subplots(figsize=(7, 4.5))
draw_map(axes, rooms)
for clearance, colour in ((0.0, '#0072B2'), (0.8, '#D55E00')):
    result = plan(space, start, goal, clearance=clearance, seed=1, time_limit=60)
    draw_path(axes, result.path, colour=colour)
    least = space.path_clearance(result.path)
    print(f'clearance={clearance}: {result.length:.2f} m, at least {least:.2f} m from obstacles')
draw_ends(axes, start, goal)
axes.set_title('shortest, and with a clearance of 0.8 m')
plt.show()
