"""Entries of the table of experiments."""

from typing import NamedTuple


class ExperimentEntry(NamedTuple):
    """
    An experiment in the table of all experiments.

    Attributes
    ----------
    name : str
        Name of the experiment on the command line, and of its page and files.
    module : str
        Full name of the module that defines ``EXPERIMENT``.
    summary : str
        What the experiment measures, in one line.

    """

    name: str
    module: str
    summary: str
