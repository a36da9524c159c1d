"""Systems: robots with inertia, their limits on speed and acceleration, and their motion."""

from hnr_planner.core.systems.car import Car
from hnr_planner.core.systems.double_integrator import DoubleIntegrator
from hnr_planner.core.systems.system import System
from hnr_planner.core.systems.trajectory import join_trajectories, Trajectory

__all__ = ['Car', 'DoubleIntegrator', 'System', 'Trajectory', 'join_trajectories']
