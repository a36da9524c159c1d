"""Small maps, drawn by hand, on which the laws are held: '#' is occupied, row 0 at the bottom."""

import numpy as np
from numpy.typing import NDArray


def drawn(*lines: str) -> NDArray[np.bool_]:
    """Return a picture as occupied cells; its last line is row 0."""
    return np.array([[mark == '#' for mark in line] for line in reversed(lines)])


U_SHAPE = drawn(
    '..###..',
    '..###..',
    '..###..',
    '..###..',
    '..###..',
    '..###..',
    '.......',
    '.......',
    '.......',
)
"""45 free cells; two arms of unequal visibility from the bottom."""

TWO_ROOMS = drawn(
    '.....#.....',
    '.#...#.....',
    '.....#..##.',
    '...........',
    '.....#.....',
    '..#..#...#.',
    '...#.#.....',
)
"""A door one cell wide, single cells, and a diagonal pair."""

CHECKERBOARD = np.indices((6, 8)).sum(axis=0) % 2 == 1

SPIRAL = drawn(
    '.........',
    '########.',
    '.......#.',
    '.#####.#.',
    '.#.....#.',
    '.#######.',
    '.........',
)

CORRIDOR = np.zeros((1, 30), dtype=bool)

ONE_CELL = np.zeros((1, 1), dtype=bool)


def speckle(rows: int, cols: int, density: float, seed: int) -> NDArray[np.bool_]:
    """Return cells occupied at random."""
    return np.random.default_rng(seed).random((rows, cols)) < density


def rooms(rows: int, cols: int, size: int, seed: int) -> NDArray[np.bool_]:
    """Return square rooms with walls one cell thick and a door in most walls."""
    rng = np.random.default_rng(seed)
    occupied = np.zeros((rows, cols), dtype=bool)
    occupied[size::size] = True
    occupied[:, size::size] = True
    for row in range(0, rows, size):
        for col in range(0, cols, size):
            along = int(rng.integers(1, size - 1))
            if rng.random() < 0.8 and row + along < rows:
                occupied[row + along, col] = False
            if rng.random() < 0.8 and col + along < cols:
                occupied[row, col + along] = False
    return occupied


def spiral(size: int, pitch: float) -> NDArray[np.bool_]:
    """Return a round spiral with walls about two cells thick, `pitch` cells apart."""
    y, x = np.indices((size, size)) - size / 2
    turns = np.hypot(x, y) / pitch - np.arctan2(y, x) / (2 * np.pi)
    return turns % 1 < 2 / pitch


def wide_hall(rows: int, cols: int) -> NDArray[np.bool_]:
    """Return an empty hall with four pillars: nearly every ray crosses far over free cells."""
    occupied = np.zeros((rows, cols), dtype=bool)
    for row in (rows // 4, 3 * rows // 4):
        for col in (cols // 4, 3 * cols // 4):
            top, right = row + 3, col + 2
            occupied[row:top, col:right] = True
    return occupied


def single_cells_and_diagonals(size: int) -> NDArray[np.bool_]:
    """Return lone cells on one half, and on the other diagonal rows that touch by corners."""
    row, col = np.indices((size, size))
    lone = (row % 7 == 3) & (col % 7 == 3) & (col < size // 2)
    diagonal = (row + 2 * (row // 16)) % 16 == col % 16
    return lone | (diagonal & (col >= size // 2) & (row % 16 != 0))
