"""Corridors for robots with inertia, as blocked cells: a serpentine and a Z."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

RESOLUTION = 0.05
ARM, WALL = 10.0, 0.1


def serpentine(width: float) -> NDArray[np.bool_]:
    """Build three parallel arms of 10 m, joined by two turns: the paper's two-turn corridor."""
    w, length, wall = (round(each / RESOLUTION) for each in (width, ARM, WALL))
    blocked = np.zeros((3 * w + 2 * wall, length), dtype=bool)
    blocked[w:][:wall, : length - w] = True
    upper = 2 * w + wall
    blocked[upper:][:wall, w:] = True
    return blocked


def zigzag(width: float) -> NDArray[np.bool_]:
    """Build a Z that fills a square of 10 m."""
    side, w = round(ARM / RESOLUTION), round(width / RESOLUTION)
    blocked = np.ones((side, side), dtype=bool)
    blocked[:w] = blocked[-w:] = False
    for row in range(w, side - w):
        left = round((side - w) * (side - w - row) / (side - 2 * w))
        blocked[row, left:][:w] = False
    return blocked
