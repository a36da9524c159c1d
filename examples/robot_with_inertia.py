"""
A robot with inertia
====================

A motion with bounded speed and acceleration, checked along its curves, and its speed over time.
"""

from hnr_planner import DoubleIntegrator, GridSpace, plan_trajectory
from hnr_planner.drawing import draw_ends, draw_map, draw_path
from hnr_planner.maps import OccupancyMap
from matplotlib import pyplot as plt
import numpy as np

cells = np.zeros((40, 60), np.int8)
cells[:24, 18:21] = cells[16:, 38:41] = 100
hall = OccupancyMap(cells, 0.1)
space = GridSpace.from_occupancy(hall.data, hall.resolution)
robot = DoubleIntegrator(dim=2, max_acceleration=1.0, max_speed=1.5)
start, goal = (0.5, 0.5, 0.0, 0.0), (5.5, 3.5)
result = plan_trajectory(space, robot, start, goal, goal_speed=0.0, seed=1, time_limit=120)
motion = result.trajectory
print(result.status.name, result.message)

times = np.linspace(motion.times[0], motion.times[-1], 400)
states = motion.at(times)
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8))
draw_map(left, hall)
draw_path(left, states[:, :2])
draw_ends(left, start[:2], goal)
right.plot(times, np.hypot(states[:, 2], states[:, 3]))
right.set(xlabel='time [s]', ylabel='speed [m/s]')
plt.show()
