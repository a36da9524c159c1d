"""
An arm, by an oracle
====================

The free angles of an arm with two links are a set like any other: a function says which are free.
"""

from hnr_planner import OracleSpace, plan
from matplotlib import pyplot as plt
import numpy as np
import shapely

obstacles = shapely.union_all([shapely.Point(1.1, 0.9).buffer(0.3), shapely.box(-1, -2, -0.5, 0)])


def arm(angles):
    """Return the links, each 1 m long, as a line."""
    first = np.array([np.cos(angles[0]), np.sin(angles[0])])
    both = angles[0] + angles[1]
    return shapely.LineString([(0, 0), first, first + (np.cos(both), np.sin(both))])


space = OracleSpace(
    lambda angles: not arm(angles).intersects(obstacles), (-3, -2.6), (3, 2.6), resolution=0.05
)
start, goal = (-0.6, 0.3), (2.2, -0.8)
result = plan(space, start, goal, seed=2, time_limit=60)
print(result.status.name, result.message)

figure, axes = plt.subplots(figsize=(5, 5))
axes.fill(*obstacles.geoms[0].exterior.xy, color='0.4')
axes.fill(*obstacles.geoms[1].exterior.xy, color='0.4')
for a, b in zip(result.path[:-1], result.path[1:], strict=True):
    for t in np.linspace(0, 1, 12):
        axes.plot(*arm(a + t * (b - a)).xy, color=plt.cm.viridis(t), alpha=0.5)
axes.set(aspect='equal', title=f'{len(result.path)} postures, linear in between')
plt.show()
