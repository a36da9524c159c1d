"""The ROS side: what a planning node publishes, as messages for the page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped
from hnr_planner.maps import OccupancyMap
from hnr_planner.ros.map.subscription import MapSubscription
from hnr_planner.ros.map.updates import MapUpdates
from hnr_planner.ros.messages.maps import map_from_message, map_with_update
from hnr_planner.server.map.received_maps import MapError
from hnr_planner.watch.map_images import MapImages
from hnr_planner.watch.reading import read_cloud, read_path, stamp_of
from hnr_planner.watch.searches import Search, Searches
from hnr_planner.watch.server import Point
from hnr_planner.watch.wire import pack
from nav_msgs.msg import Path
from nav_msgs.srv import GetPlan
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.clock import Clock, ClockType
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.subscription import Subscription
from rclpy.task import Future
from sensor_msgs.msg import PointCloud2

#: Latched, with room for the outcomes and paths that a planning node keeps for late subscribers.
LATCHED = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
#: Time [s] between two looks whether the planning node is there.
LOOK_EVERY = 0.5
#: Most samples of a search that are shown; with more the page would be slow.
MOST_SAMPLES = 60_000
#: Name under which a planning node tells that a newer map blocks its last path.
PATH_VALID = 'path_valid'
#: Slots of the hub that what this node hears goes into; ``node`` is kept without any viewer.
SLOTS = ('map', 'search', 'samples', 'request')

#: Takes a slot of the hub and a message for it, in any thread.
Put = Callable[[str, bytes], None]


class WatchNode(Node):
    """
    Subscribes to what a planning node publishes while somebody looks.

    All methods belong to the thread of its executor, which has to be a single one.

    Parameters
    ----------
    planner : str
        Full name of the planning node.
    map_topic : str
        Topic of the maps, relative to the planning node's namespace or absolute.
    put : callable
        Takes a slot of the hub and a message for it.
    context : Context
        The context of ROS.

    """

    def __init__(self, planner: str, map_topic: str, put: Put, context: Context) -> None:
        namespace, _, name = planner.rpartition('/')
        super().__init__(
            f'{name}_watch',
            namespace=namespace,
            context=context,
            cli_args=['--ros-args', '-r', f'map:={map_topic}'],
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._planner, self._put = planner, put
        self._runs: bool | None = None
        self._images = MapImages(lambda message: put('map', message))
        self._subscriptions_of_viewers: list[Subscription] = []
        self._map: MapSubscription | None = None
        self._updates: MapUpdates | None = None
        self._occupancy: OccupancyMap | None = None
        self._searches = Searches()
        self._shown: Search | None = None
        self._client = self.create_client(GetPlan, f'{planner}/plan')
        self._requests: dict[Future, Callable[[str], None]] = {}
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(LOOK_EVERY, self._look, clock=clock)
        self._look()

    def watch(self, wanted: bool) -> None:
        """Subscribe if ``wanted``, else unsubscribe and forget what was heard."""
        if wanted and self._map is None:
            self._subscribe()
        elif not wanted and self._map is not None:
            self._unsubscribe(self._map)

    def plan(self, start: Point, goal: Point, end: Callable[[str], None]) -> None:
        """Request a path; call ``end`` after the response, or with the reason why none comes."""
        if not self._client.service_is_ready():
            end(f'{self._planner}/plan is not there')
            return
        # Without a frame a pose is in the map's.
        request = GetPlan.Request(start=_pose(start), goal=_pose(goal))
        self._put('request', pack('request', {'start': start, 'goal': goal}))
        future = self._client.call_async(request)
        self._requests[future] = end
        future.add_done_callback(lambda done: self._requests.pop(done, _nothing)(''))

    def _subscribe(self) -> None:
        group = MutuallyExclusiveCallbackGroup()
        self._map = MapSubscription(
            self, lambda message: self._use_map(lambda: map_from_message(message)), True, group
        )
        self._updates = MapUpdates(
            self,
            f'{self._map.topic}_updates',
            lambda message: self._use_map(lambda: map_with_update(self._occupancy, message)),
            group,
        )
        self._subscriptions_of_viewers = [
            self.create_subscription(kind, f'{self._planner}/{topic}', take, LATCHED, raw=raw)
            for kind, topic, take, raw in (
                (DiagnosticArray, 'outcome', self._take_outcome, False),
                (Path, 'paths', self._take_path, True),
                (PointCloud2, 'samples', self._take_samples, False),
            )
        ]

    def _unsubscribe(self, map_subscription: MapSubscription) -> None:
        map_subscription.close()
        if self._updates is not None:
            self._updates.close()
        while self._subscriptions_of_viewers:
            self.destroy_subscription(self._subscriptions_of_viewers.pop())
        self._map = self._updates = self._occupancy = self._shown = None
        self._searches = Searches()
        self._images.forget()

    def _look(self) -> None:
        """Report to the page whether the planning node runs, and end requests if it does not."""
        runs = self.count_publishers(f'{self._planner}/outcome') > 0
        if runs == self._runs:
            return
        self._runs = runs
        self._put('node', pack('node', {'name': self._planner, 'runs': runs}))
        if not runs:
            for future, end in list(self._requests.items()):
                self._client.remove_pending_request(future)
                end(f'{self._planner} has ended')
            self._requests.clear()

    def _use_map(self, read_map: Callable[[], OccupancyMap]) -> None:
        try:
            self._occupancy = read_map()
        except MapError as error:
            self.get_logger().warning(f'map not shown: {error}')
            return
        self._images.put(self._occupancy)

    def _take_outcome(self, message: DiagnosticArray) -> None:
        status = message.status[0]
        caller = status.name.removeprefix(f'{self._planner}/')
        values = {item.key: item.value for item in status.values}
        if caller == PATH_VALID:
            if self._shown is not None:
                self._show(self._shown, f'{status.message}: {values["why"]}')
            return
        search = self._searches.add_outcome(stamp_of(message), caller, status.message, values)
        if search is not None:
            self._show(search)

    def _take_path(self, data: bytes) -> None:
        search = self._searches.add_path(*read_path(data))
        if search is not None:
            self._show(search)

    def _take_samples(self, message: PointCloud2) -> None:
        samples, parents = read_cloud(message)
        notes = []
        if len(samples) > MOST_SAMPLES:
            notes.append(f'only the first {MOST_SAMPLES:,} samples are shown')
        header = {'stamp': _text(*stamp_of(message)), 'notes': notes}
        shown = slice(MOST_SAMPLES)
        self._put('samples', pack('samples', header, [samples[shown], parents[shown]]))

    def _show(self, search: Search, notice: str = '') -> None:
        """Show a request; ``notice`` is what has become of its path since."""
        self._shown = search
        header: dict[str, Any] = {
            'stamp': _text(*search.stamp),
            'caller': search.caller,
            'status': search.status,
            'why': search.values.get('why', ''),
            'values': search.values,
            'notice': notice,
        }
        paths = [path for path in search.paths if len(path)]
        self._put('search', pack('search', header, paths))


def _pose(point: Point) -> PoseStamped:
    message = PoseStamped()
    message.pose.position.x, message.pose.position.y = point
    message.pose.orientation.w = 1.0
    return message


def _text(sec: int, nanosec: int) -> str:
    """Return a stamp as text [s]: a number of JavaScript would lose its last digits."""
    return f'{sec}.{nanosec:09d}'


def _nothing(_why: str) -> None:
    """Do nothing: the end of a request that was given up."""
