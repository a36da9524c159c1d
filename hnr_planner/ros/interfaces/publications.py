"""What is published about each request, besides its outcome."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from hnr_planner.ros.messages.markers import serialised_markers
from hnr_planner.ros.messages.paths import serialised_path
from hnr_planner.ros.messages.samples import draws_message, samples_message
from hnr_planner.ros.messages.trajectories import serialised_trajectory
from hnr_planner.server.request_log import LogEntry
from hnr_planner.server.responses import PlanResponse, Response, SampleResponse
from nav_msgs.msg import Path
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Header
from trajectory_msgs.msg import MultiDOFJointTrajectory
from visualization_msgs.msg import MarkerArray

#: Topics of publications, besides the outcome, and their types.
TOPICS = {
    'path': Path,
    'trajectory': MultiDOFJointTrajectory,
    'samples': PointCloud2,
    'markers': MarkerArray,
}

#: Topics, each with a message or its serialised form.
Messages = Iterator[tuple[str, Any]]


@dataclass(frozen=True, eq=False)
class Publication(ABC):
    """
    What is published about one request.

    Parameters
    ----------
    caller : str
        Service, action or topic that the request came by.
    response : Response
        How it ended.
    header : Header
        Header of all messages; the publisher sets its stamp.
    log : LogEntry
        The line for the log.

    """

    caller: str
    response: Response
    header: Header
    log: LogEntry

    @abstractmethod
    def messages(self) -> Messages:
        """Yield what was requested."""

    def pictures(self) -> Messages:
        """Yield what is for people to look at, and may be left out in a hurry."""
        yield from ()


@dataclass(frozen=True, eq=False)
class PlanPublication(Publication):
    """
    What is published about a request for a path.

    Parameters
    ----------
    samples_max : int
        Most samples to publish.

    """

    response: PlanResponse
    samples_max: int

    def messages(self) -> Messages:
        """Yield path and trajectory."""
        yield 'path', serialised_path(self.response.poses, self.header)
        yield 'trajectory', serialised_trajectory(self.response.trajectory, self.header)

    def pictures(self) -> Messages:
        """Yield samples and markers."""
        yield 'samples', samples_message(self.response.result, self.samples_max, self.header)
        yield 'markers', serialised_markers(self.response, self.header)


@dataclass(frozen=True, eq=False)
class SamplePublication(Publication):
    """What is published about a request for draws."""

    response: SampleResponse

    def messages(self) -> Messages:
        """Yield the draws."""
        yield 'samples', draws_message(self.response, self.header)
