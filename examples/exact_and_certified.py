"""
Exact, with a proof
===================

``Polyanya`` finds the shortest path on a grid; its length is a lower bound for every other path.
"""

from pathlib import Path
import sys

from hnr_planner import GridSpace, plan, Polyanya
from hnr_planner.drawing import draw_ends, draw_map, draw_path
from hnr_planner.maps import load_map
from matplotlib import pyplot as plt

clone = Path(sys.argv[0]).resolve().parents[1]
office = load_map(clone / 'config/maps/office.yaml')
space = GridSpace.from_occupancy(office.data, office.resolution, office.origin, robot_radius=0.22)
start, goal = (3.0, 22.0), (34.0, 5.0)
found = plan(space, start, goal, algorithm='hit_and_run_connect', seed=5, time_limit=60)
exact = plan(space, start, goal, algorithm=Polyanya(), time_limit=60)
print(f'found {found.length:.3f} m, no path is shorter than {exact.lower_bound:.3f} m')

figure, axes = plt.subplots(figsize=(8, 6))
draw_map(axes, office, space.blocked)
draw_path(axes, found.path, colour='#0072B2')
draw_path(axes, exact.path)
draw_ends(axes, start, goal)
axes.set_title(f'{found.length / exact.lower_bound - 1:.1%} longer than the shortest')
plt.show()
