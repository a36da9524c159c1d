"""The messages for the page, read as the page reads them."""

import json
from typing import Any

import numpy as np


def read(message: bytes) -> tuple[dict[str, Any], list[np.ndarray]]:
    """Return the header of a message and its arrays, each of which has to be aligned."""
    size = int.from_bytes(message[:4], 'little')
    header = json.loads(message[4:][:size])
    at, arrays = 4 + size, []
    for kind, count in header['blobs']:
        dtype = np.dtype(kind).newbyteorder('<')
        assert at % 8 == 0
        arrays.append(np.frombuffer(message, dtype, count, at))
        at += -(-count * dtype.itemsize // 8) * 8
    assert at == len(message)
    return header, arrays
