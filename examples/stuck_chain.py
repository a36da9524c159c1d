"""
Diagnose a stuck chain
======================

Two rooms with a narrow door: each chain stays in its room, and the diagnosis says so.
"""

from hnr_planner import diagnose, PolygonSpace, sample
from matplotlib import pyplot as plt
import shapely

rooms = shapely.union_all(
    [shapely.box(0, 0, 1, 1), shapely.box(1.02, 0, 2, 1), shapely.box(0.9, 0.5, 1.1, 0.501)]
)
space = PolygonSpace(rooms)
chains = sample(space, [(0.5, 0.3), (1.5, 0.3)], 150, thin=2, seed=1)
verdict = diagnose(chains)
print(verdict.message)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6))
left.plot(*rooms.exterior.xy, color='black', lw=1)
for chain in chains:
    left.scatter(*chain.T, s=5)
    right.plot(chain[:, 0], lw=0.7)
left.set(aspect='equal', title='two chains, two rooms')
right.set(xlabel='draw', ylabel='x [m]', title='not converged')
plt.show()
