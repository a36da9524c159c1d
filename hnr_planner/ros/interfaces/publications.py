"""Publications: the messages about each request besides its outcome, and its log line."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from hnr_planner.ros.messages.markers import serialised_markers
from hnr_planner.ros.messages.paths import serialised_path
from hnr_planner.ros.messages.samples import serialised_draws, serialised_samples
from hnr_planner.ros.messages.trajectories import serialised_trajectory
from hnr_planner.server.responses.plan_response import PlanResponse
from hnr_planner.server.responses.request_log import LogEntry
from hnr_planner.server.responses.response import Response
from hnr_planner.server.responses.sample_response import SampleResponse
from nav_msgs.msg import Path
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Header
from trajectory_msgs.msg import MultiDOFJointTrajectory
from visualization_msgs.msg import MarkerArray

#: Names below the node's of the topics of publications, besides the outcome, and their types.
TOPICS = {
    'path': Path,
    'paths': Path,
    'trajectory': MultiDOFJointTrajectory,
    'samples': PointCloud2,
    'markers': MarkerArray,
}

#: Functions that make a message for a topic of ``TOPICS``, by the topic.
Pictures = dict[str, Callable[[], Any]]

#: Pairs of a topic of ``TOPICS`` and a message for it, as an object or serialised.
Messages = Iterator[tuple[str, Any]]


@dataclass(frozen=True, eq=False)
class Publication(ABC):
    """
    All that is published and logged about one request.

    Parameters
    ----------
    caller : str
        Service, action or topic that the request came by.
    response : Response
        How the request ended.
    header : Header
        Header of all messages; the publisher sets its stamp before they are made.
    log : LogEntry
        The line on the log about the request.

    """

    caller: str
    response: Response
    header: Header
    log: LogEntry

    @abstractmethod
    def messages(self) -> Messages:
        """Yield the messages with what was requested, which are always published."""

    def pictures(self) -> Pictures:
        """Return messages for people to look at, by their topics, as functions that make them."""
        return {}


@dataclass(frozen=True, eq=False)
class PlanPublication(Publication):
    """
    All that is published and logged about a request for a path.

    Parameters
    ----------
    samples_max : int
        Most samples of the search to publish.

    """

    response: PlanResponse
    samples_max: int

    @cached_property
    def path(self) -> bytes:
        """The path as a serialised message; to be taken once the header has its stamp."""
        return serialised_path(self.response.poses, self.header)

    def messages(self) -> Messages:
        """Yield the messages of path, alternatives and trajectory, empty where there is none."""
        yield 'path', self.path
        yield 'paths', self.path
        for poses in self.response.other_poses:
            yield 'paths', serialised_path(poses, self.header)
        yield 'trajectory', serialised_trajectory(self.response.trajectory, self.header)

    def pictures(self) -> Pictures:
        """Return the samples of the search, and the markers that show it in RViz."""
        return {
            'samples': lambda: serialised_samples(
                self.response.result, self.samples_max, self.header
            ),
            'markers': lambda: serialised_markers(self.response, self.header),
        }


@dataclass(frozen=True, eq=False)
class SamplePublication(Publication):
    """All that is published and logged about a request for draws of the free space."""

    response: SampleResponse

    def messages(self) -> Messages:
        """Yield the draws as a point cloud; it is empty after a failure."""
        yield 'samples', serialised_draws(self.response, self.header)
