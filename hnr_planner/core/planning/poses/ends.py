"""Start and goals of a request for a path of poses, and whether a disc joins them."""

from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.borrowed import borrowed
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.spaces.grid.traversal import GridData
from hnr_planner.core.spaces.poses.data import PoseData
from hnr_planner.core.spaces.poses.disc import disc_place
from hnr_planner.core.spaces.poses.frame import pose_to_cells, PoseFrame
from hnr_planner.core.spaces.primitives import component, contains
import numpy as np
from numpy.typing import NDArray

#: Stands for the component of a pose that is not free.
NOT_FREE = -1


@kernel
def place_ends(
    space: PoseData, frame: PoseFrame, disc: GridData, centre: Floats, poses: Floats
) -> tuple[Floats, NDArray[np.int64]]:
    """
    Return poses (k, 3) of the map frame in the kernel frame, and the component of each, (k,).

    A component is the number, from 1, of a connected part of the places that the largest disc in
    the footprint can be in; it is ``NOT_FREE`` where the footprint is not free.

    Parameters
    ----------
    space : PoseData
        The free poses.
    frame : PoseFrame
        The frame of the grid.
    disc : GridData
        The free places of the disc's centre.
    centre : (2,)
        The disc's centre in the robot's frame [cells].
    poses : (k, 3)
        Poses in the map frame.

    """
    space, disc = borrowed(space), borrowed(disc)
    cells, components = np.empty_like(poses), np.empty(len(poses), dtype=np.int64)
    place = np.empty(2)
    for k in range(len(poses)):
        pose_to_cells(frame, poses[k], cells[k])
        components[k] = NOT_FREE
        if contains(space, cells[k]):
            place[0], place[1] = disc_place(centre, cells[k])
            components[k] = component(disc, place)
    return cells, components
