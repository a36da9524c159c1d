"""
Anneal to a global minimum
==========================

A function with many minima, on a floor with a pillar: Hit-and-Run from ever colder densities
finds the lowest, and a walk at one temperature shows where the others are.
"""

from hnr_planner import anneal, BallSpace, BoxSpace, DifferenceSpace, HitAndRunWalk, sample
from matplotlib import pyplot as plt
from numba import njit
import numpy as np

floor = DifferenceSpace(BoxSpace((-2, -2), (2, 2)), BallSpace((0.2, 0.3), 0.8))


@njit
def height(x):
    """Return a bowl with waves; its lowest point is (-1.2, -1.2)."""
    bowl = 0.2 * ((x[0] + 1.2) ** 2 + (x[1] + 1.2) ** 2)
    return bowl - np.cos(4 * (x[0] + 1.2)) * np.cos(4 * (x[1] + 1.2))


best = anneal(floor, height, (1.8, 1.8), n_steps=5000, seed=1)
warm = HitAndRunWalk(njit(lambda x: -3 * height(x)))
draws = sample(floor, (1.8, 1.8), 3000, walk=warm, thin=5, seed=2)[0]
print(f'lowest point {best.point.round(3)}, height {best.value:.4f}')

x, y = np.meshgrid(np.linspace(-2, 2, 200), np.linspace(-2, 2, 200))
figure, axes = plt.subplots(figsize=(6, 5))
axes.contourf(x, y, height(np.stack([x, y])), 30, cmap='viridis')
axes.add_patch(plt.Circle((0.2, 0.3), 0.8, color='white'))
axes.scatter(*draws.T, s=2, color='white', label='draws at one temperature')
axes.plot(*best.point, 'r*', ms=15, label='found by annealing')
axes.legend(loc='upper right')
axes.set_aspect('equal')
plt.show()
