"""
Parking backwards
=================

A car drives past a bay and backs into it: every pose on the way is free, not only some of them.
"""

import math

from hnr_planner import GridSpace, plan, PoseSpace
from hnr_planner.drawing import draw_map
from hnr_planner.maps import OccupancyMap
from matplotlib import pyplot as plt
import numpy as np

cells = np.zeros((50, 80), np.int8)
cells[:18] = 100
cells[:18, 36:46] = 0  # the bay is one metre wide
street = OccupancyMap(cells, 0.1)
footprint = np.array([(-0.3, -0.3), (0.9, -0.3), (0.9, 0.3), (-0.3, 0.3)])
space = PoseSpace(
    GridSpace.from_occupancy(street.data, street.resolution),
    footprint,
    drive='car',
    min_turning_radius=1.0,
)
start, goal = (1.5, 3.0, 0.0), (4.1, 0.5, math.pi / 2)
result = plan(space, start, goal, seed=2, time_limit=math.inf, max_iterations=5000)
backwards = int((result.twists[:, 0] < 0.0).sum())
print(f'{result.status.name}: {len(result.twists)} motions, {backwards} of them backwards')

figure, axes = plt.subplots(figsize=(7.5, 5))
draw_map(axes, street)
poses = result.poses(0.25)
for (x, y, yaw), colour in zip(poses, plt.cm.viridis(np.linspace(0, 1, len(poses))), strict=True):
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    axes.fill(*(footprint @ turn.T + (x, y)).T, facecolor='none', edgecolor=colour)
axes.plot(poses[:, 0], poses[:, 1], 'k-', lw=1)
axes.set_title(f'{result.length:.1f} m, {backwards} of {len(result.twists)} motions backwards')
plt.show()
