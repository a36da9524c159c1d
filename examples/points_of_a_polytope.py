"""
Uniform points of a polytope
============================

The simplex in three dimensions: 800 uniform points by Hit-and-Run along the coordinates.
"""

from hnr_planner import diagnose, PolytopeSpace, sample
from matplotlib import pyplot as plt
import numpy as np

simplex = PolytopeSpace(np.vstack([-np.eye(3), np.ones(3)]), [0, 0, 0, 1])
chains = sample(
    simplex,
    np.full(3, 0.25),
    200,
    walk='coordinate_hit_and_run',
    n_chains=4,
    burn_in=50,
    thin=10,
    seed=3,
)
print(diagnose(chains).message)

figure = plt.figure(figsize=(6, 5))
axes = figure.add_subplot(projection='3d')
for chain in chains:
    axes.scatter(*chain.T, s=6)
axes.set_title('one colour for each of four chains')
plt.show()
