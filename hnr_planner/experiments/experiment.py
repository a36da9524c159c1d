"""The parts of an experiment: cases, measurement, figure and tables."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hnr_planner.experiments.entry import ExperimentEntry
from hnr_planner.experiments.results import Results
from matplotlib.figure import Figure


@dataclass(frozen=True)
class Experiment:
    """
    An experiment: the cases of a claim of the paper, and how they are measured and shown.

    Attributes
    ----------
    entry : ExperimentEntry
        Entry of the experiment in the registry: name, module and summary.
    runs : int
        Number of runs of every case in the results that ``docs/`` shows.
    cases : callable
        Returns the cases: NamedTuples of strings and numbers, all of one type. Their fields are
        columns of the results.
    run : callable
        ``run(case, seed)`` measures one case and returns further columns, the same for every
        case. It is a pure function at the top level of its module, so that other processes can
        import it.
    figure : callable
        ``figure(results)`` returns a matplotlib figure of the results.
    tables : callable
        ``tables(results)`` returns the tables of the results as Markdown.

    """

    entry: ExperimentEntry
    runs: int
    cases: Callable[[], Sequence[Any]]
    run: Callable[[Any, int], Mapping[str, float]]
    figure: Callable[[Results], Figure]
    tables: Callable[[Results], str]

    @property
    def name(self) -> str:
        """Name of the experiment on the command line, and of its page and files."""
        return self.entry.name
