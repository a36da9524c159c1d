"""
A lifecycle node whose transitions are methods, and which responds to failed transitions too.

A subclass overrides ``configure``, ``activate``, ``deactivate`` and ``cleanup``; the last two may
also run when they have nothing to undo. A transition that fails is logged with its traceback and
leads back to unconfigured. A transition that the state does not allow is logged, and refused in
the response of the service ``change_state``; rclpy alone would send no response.
"""

from collections.abc import Callable
import traceback

from lifecycle_msgs.srv import ChangeState
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn


class ManagedNode(LifecycleNode):
    """
    A node with the life cycle of ROS 2.

    ``state`` is 'unconfigured', 'inactive', 'active' or 'finalized'; it changes once a transition
    has succeeded.
    """

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.state = 'unconfigured'
        self._refuse_in_the_response()

    def configure(self) -> None:
        """Acquire what the node needs to serve, on the way from unconfigured to inactive."""

    def activate(self) -> None:
        """Begin to serve, on the way from inactive to active."""

    def deactivate(self) -> None:
        """Stop serving, on the way from active to inactive, at a shutdown or after a failure."""

    def cleanup(self) -> None:
        """Release what ``configure`` acquired: at a cleanup, a shutdown or after a failure."""

    def end_transitions(self) -> None:
        """
        End the service ``change_state``, so that no request comes after the last response.

        To be called while the node still spins, so that earlier requests get their responses.
        """
        self.destroy_service(self._change_state)

    def destroy_node(self) -> None:
        """Shut the node down from any state, unless it is finalized already, and destroy it."""
        if self.state != 'finalized':
            self.trigger_shutdown()
        super().destroy_node()

    def on_configure(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``configure``, and return whether the node is inactive then."""
        return self._pass_to('inactive', self.configure)

    def on_activate(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``activate``, and return whether the node is active then."""
        return self._pass_to('active', self.activate)

    def on_deactivate(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``deactivate``, and return whether the node is inactive then."""
        return self._pass_to('inactive', self.deactivate)

    def on_cleanup(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``cleanup``, and return whether the node is unconfigured then."""
        return self._pass_to('unconfigured', self.cleanup)

    def on_shutdown(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``deactivate`` and ``cleanup``; the node is finalized then, for good."""
        return self._pass_to('finalized', self.deactivate, self.cleanup)

    def on_error(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Run ``deactivate`` and ``cleanup`` after a failed transition, back to unconfigured."""
        return self._pass_to('unconfigured', self.deactivate, self.cleanup)

    def _pass_to(self, state: str, *steps: Callable[[], None]) -> TransitionCallbackReturn:
        """Run ``steps`` in order; return SUCCESS in the new ``state``, ERROR if a step raises."""
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
        """
        Replace the callback of ``change_state`` by one that responds to every request.

        For a transition that the state does not allow, rclpy's own callback raises, so that its
        caller would wait for ever.
        """
        self._change_state = next(item for item in self.services if item.srv_type is ChangeState)
        change_state = self._change_state.callback

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

        self._change_state.callback = respond
