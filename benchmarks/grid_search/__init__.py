"""
Grid search, as most robots plan today, compiled: A*, Theta*, and a wavefront over the whole map.

Steps lead from cell centre to cell centre, to one of eight neighbours, and cut no corner: a
diagonal one needs all four cells free. Grids are compiled ones with a blocked rim.
"""

from benchmarks.grid_search.a_star import a_star
from benchmarks.grid_search.pull_string import pull_string
from benchmarks.grid_search.theta_star import theta_star
from benchmarks.grid_search.wavefront import wavefront

__all__ = ['a_star', 'pull_string', 'theta_star', 'wavefront']
