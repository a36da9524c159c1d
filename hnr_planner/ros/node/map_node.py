"""The executable ``map_node``: publishes a map file where Nav2's ``map_server`` is missing."""

from collections.abc import Sequence
from dataclasses import replace
import sys
from typing import NoReturn
import warnings

from hnr_planner.maps import load_map, MapFileError, MapFileWarning, OccupancyMap
from hnr_planner.ros.interfaces.profiles import latched
from hnr_planner.ros.messages.maps import message_from_map
from hnr_planner.ros.node.process import run
from hnr_planner.ros.node.unknown_parameters import warn_of_unknown_parameters
from hnr_planner.server.responses.request_log import shortened
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

#: Name of the node.
NAME = 'map_source'

#: Name, default and description of each parameter.
PARAMETERS = (
    ('yaml_filename', '', 'Map file: YAML of map_server, or .map of the Moving AI benchmarks.'),
    ('frame_id', 'map', 'Frame of the map.'),
)


class MapSource(Node):
    """
    Publishes the map of the file in the parameter ``yaml_filename``, latched, and serves it.

    The topic is ``map``, the service ``~/map``. When a parameter is set, the file is loaded again
    and published.

    Raises
    ------
    MapFileError
        When no file is named or it cannot be used at the start. Later, a parameter that names
        such a file is refused, and the map that is loaded stays.

    """

    def __init__(self) -> None:
        super().__init__(NAME)
        for name, default, description in PARAMETERS:
            self.declare_parameter(name, default, ParameterDescriptor(description=description))
        warn_of_unknown_parameters(self)
        self._publisher = self.create_publisher(OccupancyGrid, 'map', latched(1))
        self._message = self._load({})
        self._next = self._message
        self._publish()
        self.add_on_set_parameters_callback(self._check)
        self.add_post_set_parameters_callback(self._accept)
        self.create_service(GetMap, '~/map', self._respond)

    def _load(self, changes: dict[str, str]) -> OccupancyGrid:
        """Return the map for the parameters with ``changes`` made, or raise MapFileError."""
        now = {name: self.get_parameter(name).value for name, _, _ in PARAMETERS}
        wanted = now | changes
        filename = wanted['yaml_filename']
        if not filename:
            raise MapFileError('the parameter yaml_filename is empty: no map file is given')
        occupancy = replace(self._read(filename), frame=wanted['frame_id'])
        self.get_logger().info(f'loaded {filename}: {occupancy}')
        return message_from_map(occupancy, self.get_clock().now().to_msg())

    def _read(self, filename: str) -> OccupancyMap:
        """Return the map of a file, or raise MapFileError; log what the loader warns about."""
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter('ignore')
            warnings.simplefilter('always', MapFileWarning)
            occupancy = load_map(filename)
        for warning in caught:
            self.get_logger().warning(shortened(str(warning.message)))
        return occupancy

    def _publish(self) -> None:
        self._publisher.publish(self._message)
        self.get_logger().info(f'ready: the map is published on {self._publisher.topic_name}')

    def _check(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        """Load the map for the parameters that are being set; refuse them if it cannot be used."""
        changes = _ours(parameters)
        if changes:
            try:
                self._next = self._load(changes)
            except MapFileError as error:
                return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _accept(self, parameters: Sequence[Parameter]) -> None:
        """Publish the map that ``_check`` loaded for the parameters that were just set."""
        if _ours(parameters):
            self._message = self._next
            self._publish()

    def _respond(self, _request: GetMap.Request, response: GetMap.Response) -> GetMap.Response:
        """Return the response with the map that was published last."""
        response.map = self._message
        return response


def _ours(parameters: Sequence[Parameter]) -> dict[str, str]:
    """Return the values, by name, of those ``parameters`` that are listed in ``PARAMETERS``."""
    names = {name for name, _, _ in PARAMETERS}
    return {item.name: item.value for item in parameters if item.name in names}


def main() -> NoReturn:
    """Run the map source until SIGINT or SIGTERM, and end the process with its exit code."""
    sys.exit(run(NAME, MapSource, threads=2))


if __name__ == '__main__':
    main()
