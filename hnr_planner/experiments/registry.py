"""
The experiments by name: one line for each, read by the command line, the pages and the tests.

Neither numba nor matplotlib is imported here, so that ``--help`` is fast: ``load`` imports the
module of one experiment. A new experiment is a module, or package, of
``hnr_planner.experiments`` with a value ``EXPERIMENT``, and a line in ``EXPERIMENTS``.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from hnr_planner.experiments.entry import ExperimentEntry

if TYPE_CHECKING:
    from hnr_planner.experiments.experiment import Experiment


_PACKAGE = 'hnr_planner.experiments'

#: Every experiment by its name, in the order of ``docs/measured.md``.
EXPERIMENTS = {
    name: ExperimentEntry(name, f'{_PACKAGE}.{name}', summary)
    for name, summary in (
        ('spiral', 'Transitions through a spiral corridor, by the width of its arms.'),
        (
            'clouds',
            'The samples of a search through the spiral: how soon, how evenly, how near to walls.',
        ),
        (
            'corridor',
            'Transitions and integration steps through a corridor with two turns, under '
            'kinematics.',
        ),
        ('safety', 'Distance to obstacles along the paths of different planners.'),
        ('restarts', 'The best path of several runs, against the shortest path.'),
        ('mixing', 'How many steps walks need to forget where they began.'),
        (
            'theory',
            'How many transitions a walk takes into a goal: computed, bounded and measured.',
        ),
    )
}

#: Names of the experiments, in the same order.
NAMES = tuple(EXPERIMENTS)


def load(name: str) -> Experiment:
    """Import an experiment of ``EXPERIMENTS`` and return it."""
    experiment: Experiment = import_module(EXPERIMENTS[name].module).EXPERIMENT
    return experiment
