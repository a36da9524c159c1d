"""
A robot that is not round
=========================

Random free poses of a long robot by a walk of drivable arcs, and the free arcs from one of them.
"""

from hnr_planner import GridSpace, PoseSpace, sample
from hnr_planner.drawing import draw_map
from hnr_planner.maps import OccupancyMap
from matplotlib import pyplot as plt
import numpy as np

cells = np.zeros((40, 60), np.int8)
cells[:16, 20:24] = cells[24:, 38:42] = 100
hall = OccupancyMap(cells, 0.1)
footprint = np.array([(-0.3, -0.25), (0.6, -0.25), (0.6, 0.25), (-0.3, 0.25)])
space = PoseSpace(
    GridSpace.from_occupancy(hall.data, hall.resolution),
    footprint,
    drive='car',
    min_turning_radius=0.8,
)
start = (1.2, 2.0, 0.0)
(poses,) = sample(space, start, 40, thin=10, seed=1)

figure, axes = plt.subplots(figsize=(7.5, 5))
draw_map(axes, hall)
for x, y, yaw in poses:
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    axes.fill(*(footprint @ turn.T + (x, y)).T, alpha=0.25)
for omega in np.linspace(-1.25, 1.25, 11):
    behind, ahead = space.chord(start, (1.0, 0.0, omega))
    t = np.linspace(behind, ahead, 80)
    angle = omega * t
    along = t * np.sinc(angle / 2 / np.pi)
    axes.plot(start[0] + along * np.cos(angle / 2), start[1] + along * np.sin(angle / 2), lw=1)
axes.set_title('40 poses, and the free arcs from the start')
plt.show()
