"""
Sets of any dimension, divided into cells along the way from the corner where walks start.

Unless a set says otherwise, all walks start at one point, ``FAR`` (nine tenths) of the way from
the middle of the set to one of its corners (a ball: to its boundary; the beams: to a corner of the
first beam).
"""

from collections.abc import Callable
from functools import cache

from hnr_planner.core import BallSpace, BoxSpace, PolytopeSpace, UnionSpace
from hnr_planner.experiments.mixing.sets import at, Cells, Floats, MixingSet
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import BSpline
from scipy.special import betaincinv, ndtri

#: Position of the start on the way from the middle (0) to the corner (1).
FAR = 0.9
#: Number of cells along the way, and in each arm of the crossed beams.
N_CELLS, N_DEPTHS = 10, 3
#: Half the length and half the width of the crossed beams.
LONG, WIDE = 1.0, 0.5


def cube(dim: int) -> MixingSet:
    """Build the unit cube; its cells are ranges of the sum of the coordinates."""
    space, corner = BoxSpace(np.zeros(dim), np.ones(dim)), np.full(dim, (1.0 - FAR) / 2.0)
    return MixingSet(space, at(corner), *_by_sum(dim, N_CELLS))


def half_full_cube(dim: int) -> MixingSet:
    """
    Build the unit cube with a uniform start in the half of it that contains the corner 0.

    The density of the start is M = 2 times that of the uniform distribution on the cube. The cells
    are ranges of the sum of the coordinates.
    """

    def starts(n_chains: int, rng: np.random.Generator) -> Floats:
        points = rng.uniform(size=(n_chains, dim))
        beyond = points.sum(axis=1, keepdims=True) > dim / 2.0
        return np.where(beyond, 1.0 - points, points)

    space = BoxSpace(np.zeros(dim), np.ones(dim))
    return MixingSet(space, starts, *_by_sum(dim, N_CELLS))


def ball(dim: int) -> MixingSet:
    """Build the ball of radius 1; its cells are slices of equal volume by the first coordinate."""
    fractions, shape = np.arange(1, N_CELLS) / N_CELLS, (dim + 1) / 2.0
    start = FAR * np.eye(dim)[0]
    edges = 2.0 * betaincinv(shape, shape, fractions) - 1.0
    return MixingSet(BallSpace(np.zeros(dim), 1.0), at(start), *_by_first(edges))


def simplex(dim: int) -> MixingSet:
    """
    Build the simplex x >= 0, sum(x) <= 1; its cells are slices of equal volume.

    The slices are ranges of the first coordinate, which exceeds t on a fraction (1 - t)^n of the
    volume.
    """
    space = PolytopeSpace(np.vstack([-np.eye(dim), np.ones(dim)]), np.append(np.zeros(dim), 1.0))
    start = np.full(dim, (1.0 - FAR) / (dim + 1.0)) + FAR * np.eye(dim)[0]
    edges = 1.0 - (1.0 - np.arange(1, N_CELLS) / N_CELLS) ** (1.0 / dim)
    return MixingSet(space, at(start), *_by_first(edges))


def joined_boxes(dim: int) -> MixingSet:
    """
    Build two unit cubes that share half of a face, for a dimension of at least 2.

    The cells of each cube are ranges of the sum of the coordinates relative to its lower corner.
    """
    shift = np.append([1.0, 0.5], np.zeros(dim - 2))
    space = UnionSpace(BoxSpace(np.zeros(dim), np.ones(dim)), BoxSpace(shift, 1.0 + shift))
    corner, n_each = np.full(dim, (1.0 - FAR) / 2.0), N_CELLS // 2
    of_sum, shares = _by_sum(dim, n_each)

    def cells(points: Floats) -> NDArray[np.int64]:
        second = points[:, 0] > 1.0
        return of_sum(points - second[:, np.newaxis] * shift) + second * n_each

    return MixingSet(space, at(corner), cells, np.tile(shares, 2) / 2.0)


def crossed_beams(dim: int) -> MixingSet:
    """
    Build a beam along each axis: a star-shaped set of 2 n arms around a central cube.

    The cells are the cube, and sections of equal length: of the first arm, of the opposite arm,
    and of all other arms together.
    """
    halves = WIDE + (LONG - WIDE) * np.eye(dim)
    space = UnionSpace(*(BoxSpace(-half, half) for half in halves))
    arm = (LONG - WIDE) / (2.0 * WIDE)  # volume of an arm over that of the cube
    pieces = np.repeat([1.0, 1.0, 2.0 * dim - 2.0], N_DEPTHS) * arm / N_DEPTHS
    shares = np.append(pieces, 1.0) / (1.0 + 2.0 * dim * arm)

    def cells(points: Floats) -> NDArray[np.int64]:
        axis = np.abs(points).argmax(axis=1)
        along = points[np.arange(len(points)), axis]
        depth = (np.abs(along) - WIDE) / (LONG - WIDE)
        arms = np.where(axis > 0, 2, along < 0.0)
        piece = np.minimum(np.floor(depth * N_DEPTHS), N_DEPTHS - 1).astype(int)
        return np.where(depth > 0.0, arms * N_DEPTHS + piece, 3 * N_DEPTHS)

    return MixingSet(space, at(FAR * halves[0]), cells, shares)


SOLIDS: dict[str, Callable[[int], MixingSet]] = {
    'cube': cube,
    'cube, from a half': half_full_cube,
    'ball': ball,
    'simplex': simplex,
    'joined boxes': joined_boxes,
    'crossed beams': crossed_beams,
}


@cache
def solid(name: str, dim: int) -> MixingSet:
    """Build a solid of ``SOLIDS`` by its name."""
    return SOLIDS[name](dim)


def _by_first(edges: Floats) -> tuple[Cells, Floats]:
    """Return cells between ``edges`` of the first coordinate, and equal volume fractions."""
    n_cells = len(edges) + 1
    return lambda points: np.searchsorted(edges, points[:, 0]), np.full(n_cells, 1.0 / n_cells)


def _by_sum(dim: int, n_cells: int) -> tuple[Cells, Floats]:
    """
    Return cells of the unit cube by the sum of the coordinates, and their fractions of volume.

    The density of the sum is the B-spline over the knots 0, 1, ..., n. The edges of the cells are
    quantiles of the normal approximation, so the fractions differ slightly; they are exact.
    """
    edges = dim / 2.0 + np.sqrt(dim / 12.0) * ndtri(np.arange(1, n_cells) / n_cells)
    below = BSpline.basis_element(np.arange(dim + 1.0)).antiderivative()(edges)
    shares = np.diff(below, prepend=0.0, append=1.0)
    return lambda points: np.searchsorted(edges, points.sum(axis=1)), shares
