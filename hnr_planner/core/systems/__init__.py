"""Systems: robots with inertia, what they can do and where that takes them."""

from hnr_planner.core.systems.car import Car
from hnr_planner.core.systems.double_integrator import DoubleIntegrator
from hnr_planner.core.systems.system import System
from hnr_planner.core.systems.trajectory import Trajectory

__all__ = ['Car', 'DoubleIntegrator', 'System', 'Trajectory']
