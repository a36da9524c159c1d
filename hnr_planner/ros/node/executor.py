"""The executor of a node: few wake-ups for each request, and an orderly end."""

from collections.abc import Callable
from typing import Any

from hnr_planner.ros.node.callback_group import BoundedCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.task import Task


class Executor(MultiThreadedExecutor):
    """
    An executor whose spinning thread itself takes what arrives for a ``BoundedCallbackGroup``.

    rclpy's own takes a request in a thread of its pool. Its spinning thread, which cannot wait for
    that request any more and for the next one not yet, is woken when it is taken and again when
    its callback has ended; in between it submits callbacks twice that have not begun. At each
    wake-up all entities of the node are collected anew, and that costs as much as the request.
    Here one that is taken at once needs no further wake-up, unless others wait for their turn.
    What its callback raises is raised in the spinning thread at the next wake-up of any kind.
    """

    def finish(self) -> None:
        """Wait until all callbacks that have begun are done, then shut the executor down."""
        self._executor.shutdown(wait=True)
        self.shutdown()

    def _make_handler(self, entity: Any, node: Any, take_from_wait_list: Callable) -> Task:
        """Take what arrived for ``entity``, and return the task that runs its callback."""
        group = entity.callback_group
        if not isinstance(group, BoundedCallbackGroup):
            return super()._make_handler(entity, node, take_from_wait_list)
        # Only this thread begins callbacks of the group: there is room, as can_execute has said.
        group.beginning_execution(entity)
        callback = take_from_wait_list(entity)

        async def handler() -> None:
            try:
                with self._work_tracker:
                    if callback is not None:
                        await callback()
            finally:
                if group.end():
                    self.wake()  # to wait for what there was no room for

        # Callbacks of the group never suspend themselves, so nobody has to resume the task.
        return Task(handler, executor=self)
