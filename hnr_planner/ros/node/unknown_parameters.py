"""Warnings of parameters that a node was started with and does not have."""

import difflib

from rclpy.node import Node


def warn_of_unknown_parameters(node: Node) -> None:
    """
    Log a warning for each parameter that the node was started with but does not declare.

    rclpy ignores such a parameter of a file or the command line without a warning. The warning
    names a declared parameter with a similar name, if there is one.
    """
    declared = list(node.get_parameters_by_prefix(''))
    # rclpy has no public name for the parameter values that a node was started with.
    for name in node._parameter_overrides:
        if node.has_parameter(name) or name.startswith('qos_overrides.'):
            continue
        close = difflib.get_close_matches(name, declared, 1)
        hint = f': did you mean {close[0]}?' if close else ''
        node.get_logger().warning(f"there is no parameter '{name}', it is ignored{hint}")
