"""
The paper's experiments: each claim measured again, with its figure and its numbers.

An experiment is one module or package of this one, named like it, with one value ``EXPERIMENT``:
a list of cases, a pure function that runs a case with a seed, and how the results become a figure
and tables. ``conduct`` does the rest for all of them. ``docs/`` says what came out.
"""

from importlib import import_module

from hnr_planner.experiments.experiment import Experiment

#: Every experiment, in the order of ``docs/README.md``.
NAMES = ('spiral', 'clouds', 'corridor', 'safety', 'mixing', 'theory')


def load(name: str) -> Experiment:
    """Return an experiment by its name; importing all of them would be slow."""
    experiment: Experiment = import_module(f'{__name__}.{name}').EXPERIMENT
    return experiment
