"""A space without what others hold."""

import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_point, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.composed import check_members, check_same_dim
from hnr_planner.core.spaces.primitives import (
    chord,
    component,
    contains,
    first_entry,
    first_exit,
    gap,
    touches,
)
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.spaces.union import UnionSpace
from numpy.typing import ArrayLike


class DifferenceData(NamedTuple):
    """
    A compiled difference.

    Attributes
    ----------
    base, removed : NamedTuple
        Compiled spaces in one frame: the points of ``base`` that ``removed`` does not touch.

    """

    base: Any
    removed: Any


class DifferenceSpace(Space):
    """
    The points of a space outside some others, whose boundaries are taken away with them.

    Parameters
    ----------
    base : Space
        What there is at first.
    *removed : Space
        What is taken away: at least one, of the same dimension.

    Raises
    ------
    SpaceError
        When the spaces do not fit, or nothing is left for certain.

    """

    def __init__(self, base: Space, *removed: Space) -> None:
        (self.base,) = check_members((base,))
        self.removed = check_members(removed)
        self.dim = check_same_dim((self.base, *self.removed))
        for k, member in enumerate(self.removed):
            if member.covers_box(*self.base.bounds):
                raise SpaceError(f'nothing is left: removed member {k} covers the whole base')
        self.data = DifferenceData(self.base.compiled, UnionSpace(*self.removed).compiled)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of the base."""
        return self.base.bounds

    @property
    def typical_clearance(self) -> float:
        """That of the base, in the caller's units, cut down by what lies in between."""
        of_base = self.base.typical_clearance * self.base.scale
        return of_base / (1.0 + len(self.removed)) ** (1.0 / self.dim)

    def why_not_free(self, point: ArrayLike) -> str:
        """Say in words why ``point`` (dim,) is not free."""
        x = check_point('point', point, self.dim)
        if not self.base.contains(x):
            return self.base.why_not_free(x)
        for k, member in enumerate(self.removed):
            if member.contains(x):
                return f'inside removed member {k}'
        return 'on the boundary of a removed member'


@contains.register(DifferenceData)
@kernel
def _contains(difference, x):
    return contains(difference.base, x) and not touches(difference.removed, x)


@touches.register(DifferenceData)
@kernel
def _touches(difference, x):
    return touches(difference.base, x) and not contains(difference.removed, x)


@first_exit.register(DifferenceData)
@kernel
def _first_exit(difference, x, u, t, enough):
    end = first_exit(difference.base, x, u, t, enough)
    return min(end, first_entry(difference.removed, x, u, t)) if end > t else t


@first_entry.register(DifferenceData)
@kernel
def _first_entry(difference, x, u, t):
    """Enter the base, and leave what is removed, until neither moves the line on."""
    s = first_entry(difference.base, x, u, t)
    while s < math.inf:
        out = first_exit(difference.removed, x, u, s, math.inf)
        if out == s:
            break
        s = first_entry(difference.base, x, u, out)
    return s


@chord.register(DifferenceData)
@kernel
def _chord(difference, x, u, back):
    lower, upper = chord(difference.base, x, u, back)
    first, last = gap(difference.removed, x, u, back)
    return max(lower, first), min(upper, last)


@component.register(DifferenceData)
@kernel
def _component(difference, x):
    """Return the part of the base: what is removed may cut it into more, but joins none."""
    return component(difference.base, x) if contains(difference, x) else 0
