"""
The rectangular spiral: a corridor that winds from a corner of a square into its centre.

The paper's experiment with positions only (its section "Planning") plans through a spiral whose
arms it makes wider or narrower, and says that a fatter middle part hurts RRT alone. The paper does
not give the geometry; this spiral starts at the bottom left, goes up first, turns right at every
corner and ends where the next arm would be shorter than it is wide. What is left in the centre is
solid.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from hnr_planner.maps.corridor import Corridor
import numpy as np


class _Arm(NamedTuple):
    """
    One straight piece of the corridor, in cells of the grid, whose row 0 is at the bottom.

    ``rows`` and ``columns`` are its rectangle, ``width`` is measured across it, and ``heading`` is
    the direction from the corridor's start to its goal.
    """

    rows: slice
    columns: slice
    width: int
    heading: int  # 0 up, 1 right, 2 down, 3 left


def spiral(
    width: float,
    *,
    resolution: float = 0.02,
    wall: float = 0.1,
    size: float = 10.0,
    middle_width: float | None = None,
) -> Corridor:
    """
    Build the spiral corridor, with a request from its outer to its inner end.

    The radius of the goal region is half the width of the last arm.

    Parameters
    ----------
    width : float
        Width of the corridor [m]; like the other lengths it is rounded to whole cells.
    resolution, wall, size : float
        Side of a cell, thickness of the walls, and side of the square, its outer walls
        included [m].
    middle_width : float, optional
        Width of the arm in the middle of the corridor's sequence of arms [m]; a wider one makes
        the corridor harder for RRT. None gives all arms the same width.

    Raises
    ------
    ValueError
        A length is not finite or not larger than half a cell, or the arms do not fit into the
        square.

    """
    if not 0 < resolution < math.inf:
        raise ValueError(f'resolution must be finite and > 0, not {resolution}')
    across = _cells('width', width, resolution)
    thickness = _cells('wall', wall, resolution)
    side = _cells('size', size, resolution)
    arms = _wind(side, thickness, [across] * side)
    if not arms:
        raise ValueError(f'a corridor of width {width} does not fit into a square of {size}')
    if middle_width is not None:
        fat = _cells('middle_width', middle_width, resolution)
        arms = _with_fat_middle(side, thickness, across, fat)
    if not arms:
        raise ValueError(f'a middle arm of width {middle_width} does not fit beside {width}')
    blocked = np.ones((side, side), bool)
    for arm in arms:
        blocked[arm.rows, arm.columns] = False
    return Corridor(
        blocked,
        resolution,
        start=_end(arms[0]._replace(heading=2), resolution),
        goal=_end(arms[-1], resolution),
        goal_radius=arms[-1].width * resolution / 2,
    )


def _cells(name: str, length: float, resolution: float) -> int:
    if not resolution / 2 < length < math.inf:
        raise ValueError(f'{name} must be finite and at least half a cell, not {length}')
    return round(length / resolution)


def _with_fat_middle(side: int, wall: int, width: int, middle_width: int) -> list[_Arm]:
    """
    Return the arms, the middle one of another width; an empty list where that does not fit.

    All lengths are in cells. A fatter arm leaves place for fewer arms, so which one is in the
    middle has to be looked for.
    """
    plain = len(_wind(side, wall, [width] * side))
    for middle in range(plain // 2, 0, -1):
        widths = [width] * side
        widths[middle] = middle_width
        arms = _wind(side, wall, widths)
        if len(arms) // 2 >= middle:
            return arms
    return []


def _wind(side: int, wall: int, widths: list[int]) -> list[_Arm]:
    """
    Lay arms of the given widths one after the other, and return those that fit.

    All lengths are in cells. Each arm turns right from the arm before it, and runs along the edge
    of the part of the square that earlier arms and their walls leave.
    """
    bottom, top, left, right = wall, side - wall, wall, side - wall
    arms: list[_Arm] = []
    behind = 0  # cells to go back so that an arm opens into the one before it
    for number, width in enumerate(widths):
        if min(top - bottom, right - left) < width:
            break
        heading = number % 4
        if heading == 0:
            rows, columns = slice(bottom - behind, top), slice(left, left + width)
            left += width + wall
        elif heading == 1:
            rows, columns = slice(top - width, top), slice(left - behind, right)
            top -= width + wall
        elif heading == 2:
            rows, columns = slice(bottom, top + behind), slice(right - width, right)
            right -= width + wall
        else:
            rows, columns = slice(bottom, bottom + width), slice(left, right + behind)
            bottom += width + wall
        arms.append(_Arm(rows, columns, width, heading))
        behind = width + wall
    return arms


def _end(arm: _Arm, resolution: float) -> tuple[float, float]:
    """
    Return the point (x, y) [m] midway between the arm's sides, half its width before its end.

    The end is the one that the arm's heading points to.
    """
    row = (arm.rows.start + arm.rows.stop) / 2
    column = (arm.columns.start + arm.columns.stop) / 2
    if arm.heading == 0:
        row = arm.rows.stop - arm.width / 2
    elif arm.heading == 1:
        column = arm.columns.stop - arm.width / 2
    elif arm.heading == 2:
        row = arm.rows.start + arm.width / 2
    else:
        column = arm.columns.start + arm.width / 2
    return column * resolution, row * resolution
