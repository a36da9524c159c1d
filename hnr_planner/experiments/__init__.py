"""
The paper's experiments: each claim measured again, with its figure and its numbers.

``registry`` lists the experiments. Each is a module or package with one value ``EXPERIMENT``: a
function that returns the cases, a pure function that measures one case with one seed, and
functions that turn the results into a figure and tables. ``conduct`` runs the cases and writes the
files. ``docs/`` has the results.
"""

from hnr_planner.experiments.entry import ExperimentEntry
from hnr_planner.experiments.registry import EXPERIMENTS, load, NAMES

__all__ = ['EXPERIMENTS', 'NAMES', 'ExperimentEntry', 'load']
