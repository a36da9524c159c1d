"""The union of spaces."""

from collections.abc import Iterable
from functools import reduce
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces.composed import check_members, check_same_dim
from hnr_planner.core.spaces.convex import is_convex, pack
from hnr_planner.core.spaces.primitives import (
    contains,
    first_entry,
    first_exit,
    touches,
)
from hnr_planner.core.spaces.space import Space
import numpy as np
from numpy.typing import ArrayLike


class UnionData(NamedTuple):
    """
    A compiled union of two; that of more is nested.

    Attributes
    ----------
    one, other : NamedTuple
        Compiled spaces in one frame.
    max_gap : float
        What may lie between them for a ray to pass.

    """

    one: Any
    other: Any
    max_gap: float


class UnionSpace(Space):
    """
    The points of any of its members.

    Members that abut are joined: gaps up to 1e-9 of the diagonal are closed, so that rooms which end
    at .3 and begin at .1 + .2 let a ray through.

    Parameters
    ----------
    *members : Space
        At least one; all of one dimension, in one frame.

    Raises
    ------
    SpaceError
        When the members make no union.

    """

    def __init__(self, *members: Space) -> None:
        self.members = check_members(members)
        self.dim = check_same_dim(self.members)
        self.data = _joined(self._leaves(), self.margin)

    def _leaves(self) -> Iterable[Any]:
        """Compiled parts, and those of parts that are unions themselves."""
        for member in self.members:
            yield from member._leaves() if isinstance(member, UnionSpace) else [member.compiled]

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,)."""
        lower, upper = zip(*(member.bounds for member in self.members), strict=True)
        return np.min(lower, axis=0), np.max(upper, axis=0)

    @property
    def typical_clearance(self) -> float:
        """Mean of those of the parts, in the caller's units."""
        return float(np.mean([member.typical_clearance * member.scale for member in self.members]))

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Say whether one of the parts is known to."""
        return any(member.covers_box(lower, upper) for member in self.members)

    def why_not_free(self, point: ArrayLike) -> str:
        """Say in words why ``point`` (dim,) is not free."""
        reasons = '; '.join(member.why_not_free(point) for member in self.members)
        return f'in none of the {len(self.members)} members of the union: {reasons}'


def _joined(leaves: Iterable[Any], max_gap: float) -> Any:
    """Return compiled parts as one, with convex pieces of a kind in the same arrays."""
    kinds: dict[Any, list[Any]] = {}
    for leaf in leaves:
        # Those that cannot be packed stay alone.
        kinds.setdefault(type(leaf) if is_convex(leaf) else id(leaf), []).append(leaf)
    packed = [pack(kind, max_gap) if is_convex(kind[0]) else kind[0] for kind in kinds.values()]
    return reduce(lambda one, other: UnionData(one, other, max_gap), packed)


@contains.register(UnionData)
@kernel
def _contains(union, x):
    return contains(union.one, x) or contains(union.other, x)


@touches.register(UnionData)
@kernel
def _touches(union, x):
    return touches(union.one, x) or touches(union.other, x)


@first_exit.register(UnionData)
@kernel
def _first_exit(union, x, u, t, enough):
    """Go to the end of a part that holds the line at ``t``, and on in one that reaches on."""
    s = max(first_exit(union.one, x, u, t, enough), first_exit(union.other, x, u, t, enough))
    if s == t:
        return t
    max_gap = union.max_gap / norm(u)
    before = t
    while before < s <= enough:
        before, probe = s, s + max_gap
        for end in (
            first_exit(union.one, x, u, probe, enough),
            first_exit(union.other, x, u, probe, enough),
        ):
            if end > probe:
                s = max(s, end)
    return s


@first_entry.register(UnionData)
@kernel
def _first_entry(union, x, u, t):
    return min(first_entry(union.one, x, u, t), first_entry(union.other, x, u, t))
