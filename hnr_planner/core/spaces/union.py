"""The union of spaces."""

from collections.abc import Iterable
from functools import reduce
from typing import Any, NamedTuple

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces.composed import check_parts, check_same_dim
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
    gap : float
        What may lie between them for a ray to pass.

    """

    one: Any
    other: Any
    gap: float


class UnionSpace(Space):
    """
    The points of any of its parts.

    Parts that abut are joined: gaps up to 1e-9 of the diagonal are closed, so that rooms which end
    at .3 and begin at .1 + .2 let a ray through.

    Parameters
    ----------
    *parts : Space
        At least one; all of one dimension, in one frame.

    Raises
    ------
    SpaceError
        When the parts make no union.

    """

    def __init__(self, *parts: Space) -> None:
        self.parts = check_parts(parts)
        self.dim = check_same_dim(self.parts)
        self.data = _joined(self._leaves(), self.margin)

    def _leaves(self) -> Iterable[Any]:
        """Compiled parts, and those of parts that are unions themselves."""
        for part in self.parts:
            yield from part._leaves() if isinstance(part, UnionSpace) else [part.part]

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,)."""
        lower, upper = zip(*(part.bounds for part in self.parts), strict=True)
        return np.min(lower, axis=0), np.max(upper, axis=0)

    @property
    def typical_clearance(self) -> float:
        """Mean of those of the parts, in the caller's units."""
        return float(np.mean([part.typical_clearance * part.scale for part in self.parts]))

    def covers_box(self, lower: Floats, upper: Floats) -> bool:
        """Say whether one of the parts is known to."""
        return any(part.covers_box(lower, upper) for part in self.parts)

    def why_not_free(self, point: ArrayLike) -> str:
        """Say in words why ``point`` (dim,) is not free."""
        reasons = '; '.join(part.why_not_free(point) for part in self.parts)
        return f'in none of the {len(self.parts)} parts of the union: {reasons}'


def _joined(leaves: Iterable[Any], gap: float) -> Any:
    """Return compiled parts as one, with convex pieces of a kind in the same arrays."""
    kinds: dict[Any, list[Any]] = {}
    for leaf in leaves:
        # Those that cannot be packed stay alone.
        kinds.setdefault(type(leaf) if is_convex(leaf) else id(leaf), []).append(leaf)
    parts = [pack(kind, gap) if is_convex(kind[0]) else kind[0] for kind in kinds.values()]
    return reduce(lambda one, other: UnionData(one, other, gap), parts)


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
    gap = union.gap / norm(u)
    before = t
    while before < s <= enough:
        before, probe = s, s + gap
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
