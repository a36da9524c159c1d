"""The union of spaces: the points that are free in at least one member."""

from collections.abc import Iterable
from functools import cached_property, reduce
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces.bounds import kernel_origin
from hnr_planner.core.spaces.composed import check_members, check_same_dim, summary
from hnr_planner.core.spaces.convex import is_convex
from hnr_planner.core.spaces.curves.curve import first_exit_on_curve
from hnr_planner.core.spaces.curves.surfaces import (
    add_crossings,
    first_exit_between_surfaces,
    max_gap_of,
)
from hnr_planner.core.spaces.piece_tree import pack_many
from hnr_planner.core.spaces.primitives import (
    CompiledSpace,
    contains,
    entry_beyond,
    first_entry,
    first_exit,
    line_touches,
    touches,
)
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike


class UnionData(NamedTuple):
    """
    A compiled union of two spaces; in a union of more, ``one`` is itself a compiled union.

    Attributes
    ----------
    one, other : NamedTuple
        Compiled spaces in one frame.
    max_gap : float
        Longest gap between the two that counts as free: a ray passes over it.

    """

    one: Any
    other: Any
    max_gap: float


class UnionSpace(Space):
    """
    The points that are free in at least one member.

    Members that abut are joined: gaps up to 1e-9 of the bounds' diagonal are closed, so a ray
    passes from a box that ends at .3 to one that begins at .1 + .2.

    Parameters
    ----------
    *members : Space
        The members, at least one; all of the same dimension, in the same frame.

    Raises
    ------
    SpaceError
        When there is no member, one is not a space, or the dimensions differ.

    Attributes
    ----------
    members : tuple of Space

    """

    def __init__(self, *members: Space) -> None:
        self.members = check_members(members)
        self.dim = check_same_dim(self.members)
        self._kernel_origin = kernel_origin(*self.bounds)

    def __repr__(self) -> str:
        """Name the dimension and the kinds of members."""
        return f'UnionSpace(dim={self.dim}, members: {summary(self.members)})'

    @cached_property
    def data(self) -> CompiledSpace:
        """The compiled union, in the kernel frame."""
        return self.compiled_at(self._kernel_origin)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,), caller's frame."""
        lower, upper = zip(*(member.bounds for member in self.members), strict=True)
        return np.min(lower, axis=0), np.max(upper, axis=0)

    @cached_property
    def typical_clearance(self) -> float:
        """Mean of the members' typical clearances, in the caller's units."""
        return float(np.mean([member.typical_clearance * member.scale for member in self.members]))

    def compiled_at(self, origin: Floats | None) -> CompiledSpace:
        """
        Return the compiled union, its coordinates along the caller's axes from ``origin``.

        ``origin`` (dim,) is a point of the caller's frame; None keeps the caller's own origin.
        """
        return _joined(self._leaves(origin), self.margin)

    def _leaves(self, origin: Floats | None) -> Iterable[CompiledSpace]:
        """Yield the compiled members, with unions among them replaced by their members."""
        for member in self.members:
            if isinstance(member, UnionSpace):
                yield from member._leaves(origin)
            else:
                yield member.compiled_at(origin)

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Return whether one member is known to contain the box between two corners (dim,)."""
        return any(member.covers_box(lower, upper) for member in self.members)

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        reasons = '; '.join(member.why_not_free(point) for member in self.members)
        return f'in none of the {len(self.members)} members of the union: {reasons}'


def _joined(leaves: Iterable[CompiledSpace], max_gap: float) -> CompiledSpace:
    """Return the union of compiled spaces, with convex pieces of one type in common arrays."""
    kinds: dict[Any, list[CompiledSpace]] = {}
    for leaf in leaves:
        # A space that cannot be packed is a kind by itself.
        kinds.setdefault(type(leaf) if is_convex(leaf) else id(leaf), []).append(leaf)
    packed = [
        pack_many(kind, max_gap) if is_convex(kind[0]) else kind[0] for kind in kinds.values()
    ]
    return reduce(lambda one, other: UnionData(one, other, max_gap), packed)


first_exit_on_curve.register(UnionData)(first_exit_between_surfaces)


@contains.register(UnionData)
@kernel
def _contains(union, x):
    """Return whether at least one of the two spaces contains ``x`` (dim,)."""
    return contains(union.one, x) or contains(union.other, x)


@touches.register(UnionData)
@kernel
def _touches(union, x):
    """Return whether the closure of at least one of the two spaces contains ``x`` (dim,)."""
    return touches(union.one, x) or touches(union.other, x)


@line_touches.register(UnionData)
@kernel
def _line_touches(union, x, u, end):
    """Return whether the line touches one of the two spaces at a parameter from 0 to ``end``."""
    return line_touches(union.one, x, u, end) or line_touches(union.other, x, u, end)


@entry_beyond.register(UnionData)
@kernel
def _entry_beyond(union, x, u, t, end):
    """Return the first entry into either up to ``end``, else ``end``; or a value up to ``t``."""
    end = entry_beyond(union.one, x, u, t, end)
    return end if end <= t else entry_beyond(union.other, x, u, t, end)


@first_exit.register(UnionData)
@kernel
def _first_exit(union, x, u, t, horizon):
    """Go to the end of a member that contains the line at ``t``, and on while one continues."""
    s = max(first_exit(union.one, x, u, t, horizon), first_exit(union.other, x, u, t, horizon))
    if s == t:
        return t
    max_gap = union.max_gap / norm(u)
    before = t
    while before < s <= horizon:
        before, probe = s, s + max_gap
        for end in (
            first_exit(union.one, x, u, probe, horizon),
            first_exit(union.other, x, u, probe, horizon),
        ):
            if end > probe:
                s = max(s, end)
    return s


@first_entry.register(UnionData)
@kernel
def _first_entry(union, x, u, t):
    """Return the first parameter from ``t`` on at which the line touches either space."""
    return min(first_entry(union.one, x, u, t), first_entry(union.other, x, u, t))


@add_crossings.register(UnionData)
@kernel
def _add_crossings(union, curve, end, crossings, n):
    """
    Append to ``crossings``, from index ``n``, where a curve meets a surface of either part.

    Return ``n`` plus the number of these parameters, also of those that do not fit.
    """
    n = add_crossings(union.one, curve, end, crossings, n)
    return add_crossings(union.other, curve, end, crossings, n)


@max_gap_of.register(UnionData)
@kernel
def _max_gap_of(union):
    """Return the length up to which gaps between or within the two spaces count as free."""
    return max(union.max_gap, max(max_gap_of(union.one), max_gap_of(union.other)))
