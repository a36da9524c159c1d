"""`sensor_msgs/PointCloud2` from the samples of a search."""

import array

from hnr_planner.core import PlanResult
from hnr_planner.ros.sample_cap import shown_samples
import numpy as np
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


def samples_message(result: PlanResult | None, limit: int, header: Header) -> PointCloud2:
    """
    Return at most `limit` samples; `parent` is the `index` of the sample it was grown from.

    A root has parent -1. Without a result the cloud is empty.
    """
    points = np.zeros(0, dtype=LAYOUT) if result is None else _points(result, limit)
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


def _points(result: PlanResult, limit: int) -> np.ndarray:
    """Return the shown samples in the layout of the message."""
    shown = shown_samples(result.parents, limit)
    points = np.zeros(len(shown.rows), dtype=LAYOUT)
    points['x'], points['y'] = result.samples[shown.rows].T
    points['index'] = np.arange(len(points))
    points['parent'] = shown.parents
    return points
