"""Example sets for the quantities, simple enough for calculations by hand."""

from test.laws.maps import drawn, U_SHAPE

from hnr_planner.core import BallSpace, BoxSpace, DifferenceSpace, GridSpace, Space, UnionSpace
from hnr_planner.core.theory.rays import chords
import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

DISC = BallSpace((0.0, 0.0), 1.0)
SQUARE = BoxSpace((0.0, 0.0), (1.0, 1.0))
BALL = BallSpace((0.0, 0.0, 0.0), 1.0)
CUBE = BoxSpace((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
#: Three unit squares around the corner (1, 1).
L_SET = GridSpace.from_blocked(drawn('.#', '..'))
#: Two crossing corridors of width 1 and length 7.
PLUS = GridSpace.from_blocked(drawn('###.###', '###.###', '###.###', '.......', *['###.###'] * 3))
#: Two arms of 2 x 6 on a base of 7 x 3.
U_SET = GridSpace.from_blocked(U_SHAPE)
#: A half disc of radius 6 above one of radius 1: every chord through 0 is divided 6 to 1.
HALF_DISCS = UnionSpace(
    DifferenceSpace(BallSpace((0.0, 0.0), 6.0), BoxSpace((-7.0, -7.0), (7.0, 0.0))),
    BallSpace((0.0, 0.0), 1.0),
)


def two_rooms(door: float) -> DifferenceSpace:
    """Return two unit squares side by side, with a door in the middle of a very thin wall."""
    return DifferenceSpace(
        BoxSpace((0.0, 0.0), (2.0, 1.0)),
        BoxSpace((1.0 - 1e-5, -1.0), (1.0 + 1e-5, 0.5 - door / 2)),
        BoxSpace((1.0 - 1e-5, 0.5 + door / 2), (1.0 + 1e-5, 2.0)),
    )


def walked(space: Space, points: Points, seed: int, n_steps: int = 1) -> Points:
    """Return points (k, dim) after steps of Hit-and-Run, drawn by NumPy on the space's chords."""
    rng = np.random.default_rng(seed)
    for _ in range(n_steps):
        directions = rng.normal(size=points.shape)
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        behind, ahead = chords(space, points, directions)
        s = rng.uniform(-behind, ahead)
        points = points + s[:, None] * directions
    return points


def scattered(space: Space, k: int, seed: int) -> Points:
    """Return k uniform points (k, dim) of the set."""
    drawn = np.random.default_rng(seed).uniform(*space.bounds, size=(20 * k, space.dim))
    return drawn[space.contains(drawn)][:k]
