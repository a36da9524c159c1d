"""Directions across the facets of a polytope, for coordinate walks in round coordinates."""

from hnr_planner.core.checks import Floats
import numpy as np

#: Largest number of directions, for each dimension.
DIRECTIONS = 3
#: Digits to which the coordinates of equal directions agree.
DIGITS = 9


def facet_axes(normals: Floats, offsets: Floats) -> Floats | None:
    """
    Return the normals of facets as directions (k, dim) of coordinate walks.

    A step along a normal changes the distance to its facet as fast as a step can, so that walks
    along all of them leave no distance behind, whichever axes the coordinates have. Of opposite
    normals one is taken; of more than ``DIRECTIONS`` for each dimension, some that are
    independent and those of the facets nearest to the origin, which lies inside. The result is
    None if these are the axes of the frame.

    Parameters
    ----------
    normals, offsets : (m, dim), (m,)
        The polytope ``normals x < offsets``, in coordinates in which it is about round; rows of
        length 1.

    """
    from scipy.linalg import qr

    dim = normals.shape[1]
    largest = np.take_along_axis(normals, np.abs(normals).argmax(axis=1)[:, np.newaxis], 1)
    turned = normals * np.sign(largest)
    _, chosen = np.unique(np.round(turned, DIGITS) + 0.0, axis=0, return_index=True)
    if len(chosen) > DIRECTIONS * dim:
        nearest = chosen[np.argsort(offsets[chosen], kind='stable')]
        _, order = qr((normals[nearest] / offsets[nearest, np.newaxis]).T, mode='r', pivoting=True)
        independent = nearest[order[:dim]]
        others = nearest[~np.isin(nearest, independent)]
        chosen = np.concatenate([independent, others[: (DIRECTIONS - 1) * dim]])
    axes = turned[np.sort(chosen)]
    is_unit = (axes != 0.0).sum(axis=1) == 1
    return None if len(axes) == dim and is_unit.all() else axes
