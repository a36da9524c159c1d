"""
Number of transitions of Hit-and-Run into a goal G, which is the length of its path.

Estimate from mixing (paper, Section 1): t_mix / sigma(G), since a mixed walk is in G with
probability sigma(G), the goal's fraction of the volume.

On the cells of a lattice the expected number itself is the solution of a linear system, so that
the two can be compared.
"""

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.theory.conductance import CellFlow
import numpy as np
from numpy.typing import NDArray

#: Number of steps after which a walk counts as one that never mixes.
STEPS_MAX = 100_000


def mixing_time(flow: CellFlow, start: int, epsilon: float = 0.25) -> int:
    """Return the steps from a cell until the law over cells is within ``epsilon`` of uniform."""
    kernel, stationary = flow.kernel, flow.area / flow.area.sum()
    law = np.zeros(len(stationary))
    law[start] = 1.0
    steps = 0
    while 0.5 * np.abs(law - stationary).sum() > epsilon:
        law = law @ kernel
        steps += 1
        if steps > STEPS_MAX:
            raise RequestError(f'not mixed after {STEPS_MAX} steps: are the cells connected?')
    return steps


def expected_transitions(flow: CellFlow, goal: NDArray[np.bool_]) -> Floats:
    """Return the mean transitions (m,) from each cell until the walk is in a ``goal`` (m,)."""
    outside = ~goal
    kernel = flow.kernel[np.ix_(outside, outside)]
    transitions = np.zeros(len(goal))
    transitions[outside] = np.linalg.solve(np.eye(len(kernel)) - kernel, np.ones(len(kernel)))
    return transitions


def mixing_estimate(mixing: float, goal_fraction: float) -> float:
    """Return the estimate t_mix / sigma(G) [steps]: one independent trial per mixing time."""
    return mixing / goal_fraction


def transitions_bound(relaxation: float, goal_fraction: float, warmth: float = 1.0) -> float:
    """
    Return the bound M t_rel (1 - sigma(G)) / sigma(G) on the expected transitions into a goal.

    For a reversible chain from its stationary law it follows from Dirichlet's principle (Aldous
    and Fill, "Reversible Markov chains and random walks on graphs", Section 3.6). From a start of
    density at most ``warmth`` M times the stationary one it takes at most M times as long.
    """
    return warmth * relaxation * (1.0 - goal_fraction) / goal_fraction
