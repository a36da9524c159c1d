"""Checks of the members of unions, differences and products, and their summary in a repr."""

from collections.abc import Iterable
from itertools import groupby
from typing import Any

from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.space import Space


def check_members(members: Iterable[Any]) -> tuple[Space, ...]:
    """
    Return the members as a tuple, or raise SpaceError.

    There has to be one, and all have to be spaces with an inside and with straight lines.
    """
    spaces = tuple(members)
    if not spaces:
        raise SpaceError('there must be at least one member, got none')
    for member in spaces:
        if not isinstance(member, Space):
            raise SpaceError(f'a member must be a space, got {member!r}')
        if not member.has_straight_lines:
            raise SpaceError(f'a member must have straight lines, got {member!r}')
        if member.kernel_dim < member.dim:
            raise SpaceError(
                f'a member must have an inside in its {member.dim} dimensions, got {member!r}, '
                f'which can only be sampled'
            )
    return spaces


def check_same_dim(members: Iterable[Space]) -> int:
    """Return the dimension that all members share, or raise SpaceError if they differ."""
    dims = sorted({member.dim for member in members})
    if len(dims) > 1:
        raise SpaceError(f'the members must be of one dimension, got {dims}')
    return dims[0]


def summary(members: Iterable[Space]) -> str:
    """Count each run of consecutive members of one kind, such as ``2 BoxSpace, 1 BallSpace``."""
    kinds = groupby(type(member).__name__ for member in members)
    return ', '.join(f'{len(list(group))} {kind}' for kind, group in kinds)
