"""
A density on a set that is not convex
=====================================

Draws from a normal density in a square with a hole, and from a density that is any function.
"""

from hnr_planner import BallSpace, BoxSpace, DifferenceSpace, Gaussian, HitAndRunWalk, sample
from matplotlib import pyplot as plt
import numpy as np

square = DifferenceSpace(BoxSpace((-2.0, -2.0), (2.0, 2.0)), BallSpace((0.0, 0.0), 0.8))


def ring(x: np.ndarray) -> float:
    """Return the log-density of points around a circle of radius 1.5."""
    return -40.0 * (np.hypot(x[0], x[1]) - 1.5) ** 2


densities = {'normal, around (1, 0)': Gaussian((1.0, 0.0), 0.5 * np.eye(2)), 'a ring': ring}
figure, axes = plt.subplots(1, 2, figsize=(8, 4), sharey=True)
for panel, (name, log_density) in zip(axes, densities.items(), strict=True):
    walk = HitAndRunWalk(log_density=log_density)
    (points,) = sample(square, (1.2, 0.5), 600, walk=walk, burn_in=20, thin=4, seed=1)
    panel.plot(*points.T, '.', ms=3)
    panel.add_patch(plt.Circle((0.0, 0.0), 0.8, color='0.8'))
    panel.set(title=name, aspect='equal', xlim=(-2, 2), ylim=(-2, 2))
plt.show()
