"""Grids, and frames of grids, that the laws of grids are held on."""

from test.laws import maps

import numpy as np

GRIDS = {
    'two rooms': maps.TWO_ROOMS,
    'u shape': maps.U_SHAPE,
    'checkerboard': maps.CHECKERBOARD,
    'spiral': maps.SPIRAL,
    'corridor': maps.CORRIDOR,
    'one cell': maps.ONE_CELL,
    'one blocked cell': ~maps.ONE_CELL,
    'speckle': maps.speckle(20, 30, 0.35, seed=5),
}

# Resolution, origin: powers of two, where every multiple of a cell is exact in floats.
EXACT_FRAMES = {
    'cells': (1.0, (0.0, 0.0, 0.0)),
    'quarter metres': (0.25, (-3.0, 5.5, 0.0)),
    'half metres': (0.5, (1.0, 2.0, 0.0)),
}

FRAMES = EXACT_FRAMES | {
    'metres': (0.05, (-12.3, 4.56, 0.0)),
    'turned': (0.05, (3.0, -2.0, 0.7)),
    'turned round': (0.1, (100.0, 200.0, np.pi)),
}


def in_map_frame(points, resolution, origin):
    """Return points, given in cells, in the map frame; written with complex numbers."""
    z = (points[..., 0] + 1j * points[..., 1]) * resolution
    z = z * np.exp(1j * origin[2]) + origin[0] + 1j * origin[1]
    return np.stack([z.real, z.imag], axis=-1)
