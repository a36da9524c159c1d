"""Samples of a search, and draws of the free space, as ``sensor_msgs/PointCloud2``."""

import array

from hnr_planner.core.planning.result import SearchResult
from hnr_planner.server.responses import SampleResponse
from hnr_planner.server.subsample import subsample_tree
import numpy as np
from numpy.typing import NDArray
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


def samples_message(result: SearchResult | None, limit: int, header: Header) -> PointCloud2:
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


def draws_message(response: SampleResponse, header: Header) -> PointCloud2:
    """
    Return a point cloud of all draws, in the map's frame [m].

    ``parent`` is the ``index`` of the draw from which the walk made its step to a draw; -1 for the
    first draw of a component, and for all when draws are several steps apart.
    """
    return _cloud(response.points, response.parents, header)


def _cloud(samples: NDArray, parents: NDArray, header: Header) -> PointCloud2:
    """Return the cloud of samples (n, 2) [m]; parents (n,) are rows of ``samples``, or -1."""
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
