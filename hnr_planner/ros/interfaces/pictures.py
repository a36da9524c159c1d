"""Pictures: messages for people to look at, made only for subscribers that are there."""

import threading

from hnr_planner.ros.interfaces.publications import Pictures
from rclpy.publisher import Publisher


class PicturePublisher:
    """
    Publishes pictures of the last request on topics, as latched topics would.

    A picture for which nobody is there is not made before somebody is: then ``catch_up`` publishes
    it.

    Parameters
    ----------
    publishers : dict
        The publisher of each topic.

    """

    def __init__(self, publishers: dict[str, Publisher]) -> None:
        self._publishers = publishers
        self._lock = threading.Lock()
        self._waiting: Pictures = {}

    def show(self, pictures: Pictures) -> None:
        """Take ``pictures`` for the last ones of their topics; publish those that are awaited."""
        with self._lock:
            self._waiting |= pictures
        self.catch_up()

    def forget(self, topic: str) -> None:
        """Forget what waits for a topic, since something newer is published there."""
        with self._lock:
            self._waiting.pop(topic, None)

    def catch_up(self) -> None:
        """Publish all that was not published yet and has a subscriber now."""
        for topic, publisher in self._publishers.items():
            if publisher.get_subscription_count() > 0:
                with self._lock:
                    make = self._waiting.pop(topic, None)
                if make is not None:
                    publisher.publish(make())
