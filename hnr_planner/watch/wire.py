"""Messages to the page: a header as JSON, and arrays."""

from __future__ import annotations

from collections.abc import Sequence
import json
from typing import Any

from numpy.typing import NDArray

#: Arrays begin at multiples of so many bytes.
ALIGNMENT = 8


def pack(kind: str, header: dict[str, Any], arrays: Sequence[NDArray] = ()) -> bytes:
    """
    Return a message as ``page/live.js`` reads it.

    Parameters
    ----------
    kind : str
        What the message is about: the name of a receiver of the page.
    header : dict
        Values for JSON.
    arrays : sequence of array
        Arrays of float32, int32 or uint8 in any shape, of which the page gets the elements.

    """
    blobs = [[array.dtype.name, array.size] for array in arrays]
    text = json.dumps({'kind': kind, **header, 'blobs': blobs}).encode()
    text += b' ' * (-(len(text) + 4) % ALIGNMENT)
    parts = [len(text).to_bytes(4, 'little'), text]
    for array in arrays:
        data = array.astype(array.dtype.newbyteorder('<'), copy=False).tobytes()
        parts += [data, bytes(-len(data) % ALIGNMENT)]
    return b''.join(parts)
