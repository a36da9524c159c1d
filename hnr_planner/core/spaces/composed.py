"""What composed spaces have in common at the door."""

from collections.abc import Iterable
from typing import Any

from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.space import Space


def check_parts(parts: Iterable[Any]) -> tuple[Space, ...]:
    """Return the parts of a composed space, at least one, or raise SpaceError."""
    spaces = tuple(parts)
    if not spaces:
        raise SpaceError('there must be at least one part, got none')
    for part in spaces:
        if not isinstance(part, Space):
            raise SpaceError(f'a part must be a space, got {part!r}')
    return spaces


def check_same_dim(parts: Iterable[Space]) -> int:
    """Return the dimension that all parts have, or raise SpaceError."""
    dims = sorted({part.dim for part in parts})
    if len(dims) > 1:
        raise SpaceError(f'the parts must be of one dimension, got {dims}')
    return dims[0]
