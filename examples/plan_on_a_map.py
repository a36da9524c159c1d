"""
Plan on a map
=============

A path for a robot of 0.22 m on a map in the format of ROS, and every sample of the search.
"""

from pathlib import Path
import sys

from hnr_planner import GridSpace, plan
from hnr_planner.drawing import draw_ends, draw_map, draw_path, draw_samples, draw_tree
from hnr_planner.maps import load_map
from matplotlib import pyplot as plt

clone = Path(sys.argv[0]).resolve().parents[1]
office = load_map(clone / 'config/maps/office.yaml')
space = GridSpace.from_occupancy(office.data, office.resolution, office.origin, robot_radius=0.22)
start, goal = (3.0, 22.0), (34.0, 5.0)
result = plan(space, start, goal, seed=1, time_limit=60)
print(result.status.name, result.message)

figure, axes = plt.subplots(figsize=(8, 6))
draw_map(axes, office, space.blocked)
draw_tree(axes, result.samples, result.parents)
draw_samples(axes, result.samples)
draw_path(axes, result.path)
draw_ends(axes, start, goal)
axes.set_title(f'{result.length:.1f} m, {result.iterations} transitions')
plt.show()
