"""
Convergence diagnostics of draws, from any sampler: functions of arrays only.

``diagnose`` computes the usual statistics and a verdict that no stuck chain passes;
``total_variation`` and ``relaxation_time`` work on draws sorted into cells; ``to_arviz`` converts
draws for arviz.

The usual statistics are computed here, and tests compare them with arviz's, because of the cost of
arviz for everybody who plans a path: 1.6 s to import (all of ``hnr_planner.core`` takes 0.75 s,
these modules 7 ms) and 130 MB with its dependencies. Its array functions alone (arviz-stats) are
small, but take 0.7 to 1.1 s and need a newer NumPy than Ubuntu 24.04 has; emcee's take 0.6 to
0.9 s and give the autocorrelation time only. Also, arviz counts the draws of chains that never
moved as independent.
"""

from hnr_planner.core.sampling.diagnostics.arviz_data import to_arviz
from hnr_planner.core.sampling.diagnostics.cells import (
    relaxation_time,
    total_variation,
    TotalVariation,
)
from hnr_planner.core.sampling.diagnostics.diagnosis import diagnose, Diagnosis

__all__ = [
    'Diagnosis',
    'TotalVariation',
    'diagnose',
    'relaxation_time',
    'to_arviz',
    'total_variation',
]
