"""Samples of a search, and draws of the free space, as serialised ``PointCloud2`` messages."""

from functools import lru_cache
import struct
from typing import NamedTuple

from hnr_planner.core.planning.result import SearchResult
from hnr_planner.server.responses.sample_response import SampleResponse
from hnr_planner.server.responses.subsample import subsample_tree
import numpy as np
from numpy.typing import NDArray
from rclpy.serialization import serialize_message
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

#: Name, NumPy format and message type of each field of a point; each field has four bytes.
COLUMNS = (
    ('x', '<f4', PointField.FLOAT32),
    ('y', '<f4', PointField.FLOAT32),
    ('z', '<f4', PointField.FLOAT32),
    ('index', '<u4', PointField.UINT32),
    ('parent', '<i4', PointField.INT32),
)

#: The NumPy type of a point, with all its fields.
LAYOUT = np.dtype([(name, form) for name, form, _ in COLUMNS])

#: Numbers in the place of width and row step, whose bytes occur in no text of a message.
WIDTH, ROW_STEP = 0xFFFEFFFE, 0xFEFFFEFF

#: Bytes before the stamp of a serialised message; bytes of a stamp; bytes of a number of points.
HEAD, STAMP, COUNT = 4, 8, 4


def serialised_samples(result: SearchResult | None, limit: int, header: Header) -> bytes:
    """
    Return a point cloud of at most ``limit`` samples of a search, in the map's frame [m].

    ``index`` is the number of a point in the cloud; ``parent`` is the ``index`` of the sample from
    which a sample was grown, -1 for a root. Parents are in the cloud. Without a result the cloud
    is empty. Of poses the positions are given.
    """
    if result is None:
        return _cloud(np.empty((0, 2)), np.empty(0), header)
    subsample = subsample_tree(result.parents, limit)
    return _cloud(result.samples[subsample.rows, :2], subsample.parents, header)


def serialised_draws(response: SampleResponse, header: Header) -> bytes:
    """
    Return a point cloud of all draws, in the map's frame [m].

    ``parent`` is the ``index`` of the draw from which the walk made its step to a draw; -1 for the
    first draw of a component, and for all when draws are several steps apart.
    """
    return _cloud(response.points, response.parents, header)


def _cloud(samples: NDArray, parents: NDArray, header: Header) -> bytes:
    """Return the cloud of samples (n, 2) [m]; parents (n,) are rows of ``samples``, or -1."""
    points = np.zeros(len(samples), dtype=LAYOUT)
    points['x'], points['y'] = samples.T
    points['index'] = np.arange(len(points))
    points['parent'] = parents
    form = _form(header.frame_id)
    stamp = struct.pack('=iI', header.stamp.sec, header.stamp.nanosec)
    width, size = (struct.pack('=I', number) for number in (len(points), points.nbytes))
    pieces = (form.head, stamp, form.to_width, width, form.to_row_step, size, size)
    return b''.join((*pieces, points.tobytes(), form.end))


class _Form(NamedTuple):
    """The bytes of a serialised cloud between its stamp, its width, its row step and its data."""

    head: bytes
    to_width: bytes
    to_row_step: bytes
    end: bytes


@lru_cache(maxsize=8)
def _form(frame: str) -> _Form:
    """Return what all clouds in a frame have in common."""
    message = PointCloud2(
        header=Header(frame_id=frame),
        height=1,
        width=WIDTH,
        fields=[
            PointField(name=name, offset=4 * place, datatype=datatype, count=1)
            for place, (name, _, datatype) in enumerate(COLUMNS)
        ],
        is_bigendian=False,
        point_step=LAYOUT.itemsize,
        row_step=ROW_STEP,
        is_dense=True,
    )
    data = serialize_message(message)
    width, row_step = (data.index(struct.pack('=I', number)) for number in (WIDTH, ROW_STEP))
    # The row step is followed by the number of bytes of the data, which is 0 here.
    after_width, end = width + COUNT, row_step + 2 * COUNT
    first = HEAD + STAMP
    return _Form(data[:HEAD], data[first:width], data[after_width:row_step], data[end:])
