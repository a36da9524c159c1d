"""
Number of steps (transitions) of Hit-and-Run until it is in a goal G: the length of its path.

Estimate from mixing (paper, Section 1): t_mix / sigma(G), since a mixed walk is in G with
probability sigma(G), the goal's fraction of the volume.

On the cells of a lattice (``conductance.CellFlow``) the expected number of steps is the solution
of a linear system, so that the estimate can be compared with the expected number.
"""

from hnr_planner.core.checks import Floats
from hnr_planner.core.errors import RequestError
from hnr_planner.core.theory.conductance import CellFlow
import numpy as np
from numpy.typing import NDArray

#: Number of steps after which a walk counts as one that never mixes.
STEPS_MAX = 100_000


def mixing_time(flow: CellFlow, start: int, epsilon: float = 0.25) -> int:
    """
    Return the steps of the chain of cells from one cell until it has mixed to within ``epsilon``.

    The chain has mixed once the total variation distance between the distribution of its cell and
    the stationary distribution is at most ``epsilon``. Stationary, the probability of a cell is
    its fraction of the set's area.

    Parameters
    ----------
    flow : CellFlow
        Flow between the cells.
    start : int
        Index of the first cell into ``flow.area``.
    epsilon : float
        Largest total variation distance, between 0 and 1.

    Raises
    ------
    RequestError
        When the chain has not mixed after ``STEPS_MAX`` steps, as with cells that are not
        connected.

    """
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
    """
    Return the mean number of steps (m,) from each cell until the chain of cells is in a goal cell.

    ``goal`` is (m,) bool, in the order of ``flow.area``: whether a cell belongs to the goal. The
    result is 0 for goal cells.
    """
    outside = ~goal
    kernel = flow.kernel[np.ix_(outside, outside)]
    transitions = np.zeros(len(goal))
    transitions[outside] = np.linalg.solve(np.eye(len(kernel)) - kernel, np.ones(len(kernel)))
    return transitions


def mixing_estimate(mixing: float, goal_fraction: float) -> float:
    """
    Return the estimate t_mix / sigma(G) of the number of steps into a goal G.

    ``mixing`` is the mixing time t_mix [steps], ``goal_fraction`` the goal's fraction sigma(G) of
    the set's volume. The estimate counts one independent trial per mixing time, each with success
    probability sigma(G).
    """
    return mixing / goal_fraction


def transitions_bound(relaxation: float, goal_fraction: float, warmth: float = 1.0) -> float:
    """
    Return the bound M t_rel (1 - sigma(G)) / sigma(G) on the expected transitions into a goal.

    ``relaxation`` is the relaxation time t_rel [steps], ``goal_fraction`` is sigma(G). For a
    reversible chain that starts from its stationary distribution, the bound with M = 1 follows
    from Dirichlet's principle (Aldous and Fill, "Reversible Markov chains and random walks on
    graphs", Section 3.6). From a start whose density is at most ``warmth`` M times the stationary
    density, the chain takes at most M times as many steps.
    """
    return warmth * relaxation * (1.0 - goal_fraction) / goal_fraction
