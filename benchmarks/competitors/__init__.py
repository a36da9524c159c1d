"""The competitors: ours, OMPL's, grid search. Each answers requests and measures its own time."""

from benchmarks.competitors.competitor import (
    Competitor,
    Missing,
    Run,
    Solver,
    SolverOf,
    TIME_LIMIT,
)
from benchmarks.competitors.lineup import lineup

__all__ = ['TIME_LIMIT', 'Competitor', 'Missing', 'Run', 'Solver', 'SolverOf', 'lineup']
