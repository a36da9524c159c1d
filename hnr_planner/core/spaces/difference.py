"""The difference of spaces: the points of a base space outside of removed spaces."""

from functools import cached_property
import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_point, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.bounds import kernel_origin
from hnr_planner.core.spaces.composed import check_members, check_same_dim, summary
from hnr_planner.core.spaces.curves.curve import first_exit_on_curve
from hnr_planner.core.spaces.curves.surfaces import (
    add_crossings,
    first_exit_between_surfaces,
    max_gap_of,
)
from hnr_planner.core.spaces.primitives import (
    chord,
    component,
    contains,
    entry_beyond,
    exit_beyond,
    first_entry,
    first_exit,
    gap,
    is_visible,
    line_touches,
    longest_apart,
    longest_ray,
    segment_is_free,
    touches,
)
from hnr_planner.core.spaces.space import Space
from hnr_planner.core.spaces.union import UnionSpace
import numpy as np
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
    The points of a space outside of others, which are removed together with their boundaries.

    Parameters
    ----------
    base : Space
        The space from which the others are removed.
    *removed : Space
        The spaces that are removed: at least one, of the same dimension.

    Raises
    ------
    SpaceError
        When the dimensions differ, or a removed space is known to cover the base.

    Attributes
    ----------
    base : Space
    removed : tuple of Space

    """

    def __init__(self, base: Space, *removed: Space) -> None:
        (self.base,) = check_members((base,))
        self.removed = check_members(removed)
        self.dim = check_same_dim((self.base, *self.removed))
        for k, member in enumerate(self.removed):
            if member.covers_box(*self.base.bounds):
                raise SpaceError(f'nothing is left: removed member {k} covers the whole base')
        self._kernel_origin = kernel_origin(*self.bounds)

    def __repr__(self) -> str:
        """Name the base and count the removed spaces by kind."""
        return f'DifferenceSpace(base={self.base!r}, removed: {summary(self.removed)})'

    @cached_property
    def data(self) -> DifferenceData:
        """The compiled difference, in the kernel frame."""
        return self.compiled_at(self._kernel_origin)

    def compiled_at(self, origin: Floats | None) -> DifferenceData:
        """
        Return the compiled space, its coordinates along the caller's axes from ``origin``.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.
        """
        removed = UnionSpace(*self.removed)
        return DifferenceData(self.base.compiled_at(origin), removed.compiled_at(origin))

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of the base."""
        return self.base.bounds

    @cached_property
    def typical_clearance(self) -> float:
        """
        Estimate of the mean clearance, in the caller's units.

        It is that of the base, over the dim-th root of 1 plus the number of removed spaces.
        """
        of_base = self.base.typical_clearance * self.base.scale
        return of_base / (1.0 + len(self.removed)) ** (1.0 / self.dim)

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        x = check_point('point', point, self.dim)
        if not self.base.contains(x):
            return self.base.why_not_free(x)
        for k, member in enumerate(self.removed):
            if member.contains(x):
                return f'inside removed member {k}'
        return 'on the boundary of a removed member'


first_exit_on_curve.register(DifferenceData)(first_exit_between_surfaces)


@contains.register(DifferenceData)
@kernel
def _contains(difference, x):
    """Return whether ``x`` is free in the base and does not touch the removed spaces."""
    return contains(difference.base, x) and not touches(difference.removed, x)


@touches.register(DifferenceData)
@kernel
def _touches(difference, x):
    """Return whether ``x`` touches the base and is not inside the removed spaces."""
    return touches(difference.base, x) and not contains(difference.removed, x)


@first_exit.register(DifferenceData)
@kernel
def _first_exit(difference, x, u, t, horizon):
    """Return the earlier of the exit from the base and the entry into the removed spaces."""
    end = first_exit(difference.base, x, u, t, horizon)
    return min(end, first_entry(difference.removed, x, u, t)) if end > t else t


@first_entry.register(DifferenceData)
@kernel
def _first_entry(difference, x, u, t):
    """
    Return the first parameter from ``t`` on at which the line touches the difference, or inf.

    Entries into the base and exits from the removed spaces alternate until neither advances.
    """
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
    """Return the chord in the base, cut to the gap between removed spaces around ``x``."""
    lower, upper = chord(difference.base, x, u, back)
    first, last = gap(difference.removed, x, u, back)
    return max(lower, first), min(upper, last)


@segment_is_free.register(DifferenceData)
@kernel
def _segment_is_free(difference, a, b):
    """
    Return whether the segment from ``a`` to ``b`` is free in the base and touches nothing removed.

    Where the line touches something a rounding beyond an end, the end itself decides.
    """
    if not segment_is_free(difference.base, a, b) or _meets_removed(difference, a, b):
        return False
    return not (touches(difference.removed, a) or touches(difference.removed, b))


@is_visible.register(DifferenceData)
@kernel
def _is_visible(difference, a, b):
    """Return whether the segment between two free points keeps to the base and off the rest."""
    return is_visible(difference.base, a, b) and not _meets_removed(difference, a, b)


@kernel
def _meets_removed(difference, a, b):
    """Return whether the line from ``a`` to ``b``, if these differ, touches what is removed."""
    u = b - a
    return u.any() and line_touches(difference.removed, a, u, 1.0)


@exit_beyond.register(DifferenceData)
@kernel
def _exit_beyond(difference, x, u, t):
    """Return the exit of the ray if it is beyond ``t``; else a value up to ``t``."""
    end = first_exit(difference.base, x, u, 0.0, math.inf)
    return end if end <= t else entry_beyond(difference.removed, x, u, t, end)


@longest_ray.register(DifferenceData)
@kernel
def _longest_ray(difference, x, directions):
    """Return which ray, cut at the end of the base, touches the removed spaces last, and where."""
    ends = np.empty(len(directions))
    for k in range(len(directions)):
        ends[k] = first_exit(difference.base, x, directions[k], 0.0, math.inf)
    return longest_apart(difference.removed, x, directions, ends)


@component.register(DifferenceData)
@kernel
def _component(difference, x):
    """Return the component of the base: removed spaces may split components, but join none."""
    return component(difference.base, x) if contains(difference, x) else 0


@add_crossings.register(DifferenceData)
@kernel
def _add_crossings(difference, curve, end, crossings, n):
    """
    Append to ``crossings``, from index ``n``, where a curve meets a surface of either part.

    Return ``n`` plus the number of these parameters, also of those that do not fit.
    """
    n = add_crossings(difference.base, curve, end, crossings, n)
    return add_crossings(difference.removed, curve, end, crossings, n)


@max_gap_of.register(DifferenceData)
@kernel
def _max_gap_of(difference):
    """Return the length up to which gaps between members of the base count as free."""
    return max_gap_of(difference.base)
