"""What is published about a request once it is answered: each kind of result tells it itself."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from hnr_planner.ros.messages.markers import serialised_markers
from hnr_planner.ros.messages.paths import serialised_path
from hnr_planner.ros.messages.samples import draws_message, samples_message
from hnr_planner.ros.messages.trajectories import trajectory_message
from hnr_planner.server.requests import PlanRequest
from hnr_planner.server.responses import PlanResponse, Response, SampleResponse
from nav_msgs.msg import Path
import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Header
from trajectory_msgs.msg import MultiDOFJointTrajectory
from visualization_msgs.msg import MarkerArray

TOPICS = {
    'path': Path,
    'trajectory': MultiDOFJointTrajectory,
    'samples': PointCloud2,
    'markers': MarkerArray,
}
"""What results are published on, besides the outcome."""
Messages = Iterator[tuple[str, Any]]
"""Topics, each with a message or its serialised form."""


@dataclass(frozen=True, eq=False)
class Publication(ABC):
    """
    What is to be told about one request.

    Parameters
    ----------
    caller : str
        Service, action or topic that the request came by.
    report : Report
        How it ended.
    header : Header
        Header of all messages; the stamp is still to be set.

    """

    caller: str
    report: Response
    header: Header

    @property
    def remark(self) -> str:
        """Return what the log has to say about the request itself, if anything."""
        return ''

    @abstractmethod
    def messages(self) -> Messages:
        """Yield what was asked for."""

    def pictures(self) -> Messages:
        """Yield what is for people to look at, and may be left out in a hurry."""
        yield from ()


@dataclass(frozen=True, eq=False)
class PlanPublication(Publication):
    """
    What is to be told about a request for a path.

    Parameters
    ----------
    request : Request
        What was asked for, as it arrived.
    poses : (n, 7)
        Its path, as `pose_rows` gives it.
    samples_max : int
        Most samples to show.

    """

    report: PlanResponse
    request: PlanRequest
    poses: NDArray[np.float64]
    samples_max: int

    @property
    def remark(self) -> str:
        """Return that the start looks like one that was left out, if it does."""
        if not self.request.omits_start:
            return ''
        return 'the start is (0, 0) in no frame, as if left out: taken literally'

    def messages(self) -> Messages:
        """Yield path and trajectory."""
        yield 'path', serialised_path(self.poses, self.header)
        yield 'trajectory', trajectory_message(self.report, self.header)

    def pictures(self) -> Messages:
        """Yield samples and markers."""
        yield 'samples', samples_message(self.report.result, self.samples_max, self.header)
        yield 'markers', serialised_markers(self.report, self.header)


@dataclass(frozen=True, eq=False)
class SamplePublication(Publication):
    """What is to be told about a request for draws."""

    report: SampleResponse

    def messages(self) -> Messages:
        """Yield the draws."""
        yield 'samples', draws_message(self.report, self.header)
