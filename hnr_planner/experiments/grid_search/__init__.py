"""
Grid search, as most robots plan today, compiled: A*, Theta*, and a wavefront over the whole map.

Steps lead from cell centre to cell centre, to one of eight neighbours, and cut no corner: a
diagonal one needs all four cells free. Grids are compiled ones with a blocked rim.
"""

from hnr_planner.experiments.grid_search.a_star import a_star
from hnr_planner.experiments.grid_search.pull_string import pull_string
from hnr_planner.experiments.grid_search.theta_star import theta_star
from hnr_planner.experiments.grid_search.wavefront import potential, wavefront

__all__ = ['a_star', 'potential', 'pull_string', 'theta_star', 'wavefront']
