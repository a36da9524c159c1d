"""`sensor_msgs/PointCloud2` from the samples of a search, or from draws of the free space."""

import array

from hnr_planner.core.planning.result import SearchResult
from hnr_planner.server.responses import SampleResponse
from hnr_planner.server.subsample import shown_samples
import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

COLUMNS = (
    ('x', '<f4', PointField.FLOAT32),
    ('y', '<f4', PointField.FLOAT32),
    ('z', '<f4', PointField.FLOAT32),
    ('index', '<u4', PointField.UINT32),
    ('parent', '<i4', PointField.INT32),
)
"""Name, format in memory and type in the message; each has four bytes."""
LAYOUT = np.dtype([(name, form) for name, form, _ in COLUMNS])


def samples_message(result: SearchResult | None, limit: int, header: Header) -> PointCloud2:
    """
    Return at most `limit` samples; `parent` is the `index` of the sample it was grown from.

    A root has parent -1. Without a result the cloud is empty.
    """
    if result is None:
        return _cloud(np.empty((0, 2)), np.empty(0), header)
    shown = shown_samples(result.parents, limit)
    return _cloud(result.samples[shown.rows], shown.parents, header)


def draws_message(report: SampleResponse, header: Header) -> PointCloud2:
    """Return all draws; `parent` is the `index` of the one that a draw is a step away from."""
    return _cloud(report.points, report.parents, header)


def _cloud(samples: NDArray, parents: NDArray, header: Header) -> PointCloud2:
    """Return samples (n, 2) with their parents (n,)."""
    points = np.zeros(len(samples), dtype=LAYOUT)
    points['x'], points['y'] = samples.T
    points['index'] = np.arange(len(points))
    points['parent'] = parents
    message = PointCloud2(
        header=header,
        height=1,
        width=len(points),
        fields=[
            PointField(name=name, offset=4 * place, datatype=datatype, count=1)
            for place, (name, _, datatype) in enumerate(COLUMNS)
        ],
        is_bigendian=False,
        point_step=LAYOUT.itemsize,
        row_step=LAYOUT.itemsize * len(points),
        is_dense=True,
    )
    message.data = array.array('B', points.tobytes())
    return message
