"""What an experiment is."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hnr_planner.experiments.results import Results
from matplotlib.figure import Figure


@dataclass(frozen=True)
class Experiment:
    """
    A claim, and how it is measured.

    Attributes
    ----------
    name : str
        Name of its module, its files and its command.
    about : str
        What it measures, in one line.
    runs : int
        Runs of every case that ``docs/`` has.
    cases : callable
        Returns the cases: NamedTuples of texts and numbers, all of one type. Their fields are
        columns of the results.
    run : callable
        ``run(case, seed)`` measures one case: a pure function, defined at the top of its module
        so that other processes find it. It returns further columns, the same for every case.
    figure : callable
        Draws the results.
    tables : callable
        Returns the numbers as Markdown.

    """

    name: str
    about: str
    runs: int
    cases: Callable[[], Sequence[Any]]
    run: Callable[[Any, int], Mapping[str, float]]
    figure: Callable[[Results], Figure]
    tables: Callable[[Results], str]
