"""
A lifecycle node whose transitions are methods, with what ``LifecycleNode`` of rclpy leaves open.

A node of this class overrides ``configure``, ``activate``, ``deactivate`` and ``cleanup``; the
last two also run when they have nothing to undo. A transition that fails is logged with its
reason and leads back to unconfigured; one that the state does not allow is refused in the service
response.
"""

from collections.abc import Callable
import traceback

from lifecycle_msgs.srv import ChangeState
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn


class ManagedNode(LifecycleNode):
    """A node with the life cycle of ROS 2; ``state`` is the name of its state."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.state = 'unconfigured'
        self._refuse_in_the_response()

    def configure(self) -> None:
        """Acquire what the node needs: unconfigured to inactive."""

    def activate(self) -> None:
        """Begin to serve: inactive to active."""

    def deactivate(self) -> None:
        """Stop serving: active to inactive."""

    def cleanup(self) -> None:
        """Release what ``configure`` acquired: inactive to unconfigured."""

    def destroy_node(self) -> None:
        """Take the node down from whatever state it is in."""
        if self.state != 'finalized':
            self.trigger_shutdown()
        super().destroy_node()

    def on_configure(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``configure``."""
        return self._pass_to('inactive', self.configure)

    def on_activate(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``activate``."""
        return self._pass_to('active', self.activate)

    def on_deactivate(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``deactivate``."""
        return self._pass_to('inactive', self.deactivate)

    def on_cleanup(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``cleanup``."""
        return self._pass_to('unconfigured', self.cleanup)

    def on_shutdown(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Undo everything, for ever."""
        return self._pass_to('finalized', self.deactivate, self.cleanup)

    def on_error(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Undo what a failed transition has left."""
        return self._pass_to('unconfigured', self.deactivate, self.cleanup)

    def _pass_to(self, state: str, *steps: Callable[[], None]) -> TransitionCallbackReturn:
        """Take the steps of a transition, and return whether they led to ``state``."""
        try:
            for step in steps:
                step()
        except Exception:  # rclpy would drop it without a word
            self.get_logger().error(f'not {state}:\n{traceback.format_exc()}')
            return TransitionCallbackReturn.ERROR
        self.get_logger().info(f'{self.state} -> {state}')
        self.state = state
        return TransitionCallbackReturn.SUCCESS

    def _refuse_in_the_response(self) -> None:
        """Respond to an impossible transition too: rclpy raises, and its caller would wait."""
        service = next(item for item in self.services if item.srv_type is ChangeState)
        change_state = service.callback

        def respond(
            request: ChangeState.Request, response: ChangeState.Response
        ) -> ChangeState.Response:
            try:
                return change_state(request, response)
            except RuntimeError as error:
                wanted = request.transition.label or request.transition.id
                reason = str(error).partition(', at ')[0]
                self.get_logger().error(f'no transition {wanted} from {self.state}: {reason}')
                response.success = False
                return response

        service.callback = respond
