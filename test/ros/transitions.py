"""States of a lifecycle node, and the transitions between them, asked for over ROS."""

from test.ros.harness import Client

from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState

UNCONFIGURED, INACTIVE, ACTIVE, FINALIZED = 'unconfigured', 'inactive', 'active', 'finalized'
CONFIGURE, CLEANUP = Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_CLEANUP
ACTIVATE, DEACTIVATE = Transition.TRANSITION_ACTIVATE, Transition.TRANSITION_DEACTIVATE
SHUTDOWN = {
    UNCONFIGURED: Transition.TRANSITION_UNCONFIGURED_SHUTDOWN,
    INACTIVE: Transition.TRANSITION_INACTIVE_SHUTDOWN,
    ACTIVE: Transition.TRANSITION_ACTIVE_SHUTDOWN,
}

#: Transitions that lead to each state from the first one, and back.
WAY_TO = {
    UNCONFIGURED: (),
    INACTIVE: (CONFIGURE,),
    ACTIVE: (CONFIGURE, ACTIVATE),
    FINALIZED: (SHUTDOWN[UNCONFIGURED],),
}
WAY_BACK = {ACTIVE: (DEACTIVATE, CLEANUP), INACTIVE: (CLEANUP,), UNCONFIGURED: ()}


def change(client: Client, *transitions: int) -> list[bool]:
    """Ask for transitions, one after the other; return whether each was made."""
    return [
        client.call(
            ChangeState,
            '/hnr_planner/change_state',
            ChangeState.Request(transition=Transition(id=transition)),
        ).success
        for transition in transitions
    ]


def state(client: Client, node: str = '/hnr_planner') -> str:
    """Return the name of the node's state."""
    answer = client.call(GetState, f'{node}/get_state', GetState.Request())
    return answer.current_state.label
