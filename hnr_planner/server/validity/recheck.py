"""Checks of the path of a response on a map that came after it."""

from hnr_planner.core import SpaceError
from hnr_planner.server.geometry.planar_pose import PlanarPose
from hnr_planner.server.geometry.pose_motions import first_contact_pose
from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.validity.path_validity import first_blocked_pose


def first_blocked(response: PlanResponse, frame: str, newest: MapSnapshot) -> PlanarPose | None:
    """
    Return the first place on the path of a response that is not free; None when all of it is.

    The path is checked for the robot that the parameters describe now: a footprint is free on all
    of its motions, and a circle on the segments between the positions.

    Parameters
    ----------
    response : PlanResponse
        A solved response, with its ``poses``.
    frame : str
        Frame of the path; on a map with another frame the path counts as blocked at its start.
    newest : MapSnapshot
        The map to check the path on.

    """
    space = newest.poses
    if space is None:
        return first_blocked_pose(response.free_path, frame, newest)
    poses, twists = response.motions
    if isinstance(space, SpaceError) or frame != newest.frame:
        return PlanarPose(*poses[0].tolist())
    place = first_contact_pose(space, poses, twists)
    return None if place is None else PlanarPose(*place.tolist())
