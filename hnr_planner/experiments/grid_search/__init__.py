"""
Compiled grid searches to compare with: A*, Theta*, and a wavefront over the whole map.

Paths lead from cell centre to cell centre, to one of eight neighbours (Theta*: to any visible
cell). A diagonal step needs all four cells around it free. Grids are compiled grid spaces, whose
outermost cells are blocked; points are (x, y) in their kernel frame (units of cells).
"""

from hnr_planner.experiments.grid_search.a_star import a_star
from hnr_planner.experiments.grid_search.pull_string import pull_string
from hnr_planner.experiments.grid_search.theta_star import theta_star
from hnr_planner.experiments.grid_search.wavefront import potential, wavefront

__all__ = ['a_star', 'potential', 'pull_string', 'theta_star', 'wavefront']
