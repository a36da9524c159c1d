"""
What draws are worth: diagnostics that look at arrays only, whoever made them.

``diagnose`` gives the usual figures and a verdict that no stuck chain passes, ``total_variation``
and ``relaxation_time`` tell more of draws that were sorted into cells, and ``to_arviz`` hands
draws on to arviz. The usual figures are computed here and held to arviz's by tests, because of
what arviz would cost everybody who plans a path: 1.6 s to import (all of ``hnr_planner.core``
takes 0.75 s, these modules 7 ms) and 130 MB with what it brings along. Its array functions alone
(arviz-stats) are small, but still take 0.7 to 1.1 s, and want a newer NumPy than Ubuntu 24.04 has;
emcee's take 0.6 to 0.9 s, and tell the autocorrelation time only. And arviz counts the draws of
chains that never moved as independent.
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
