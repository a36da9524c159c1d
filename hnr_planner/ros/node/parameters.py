"""ROS parameters of the node: declared from ``Settings``, and kept as an instance of it."""

from collections.abc import Callable
import dataclasses
from typing import Any

from hnr_planner.server.parameters.rules import Rule, SettingsError
from hnr_planner.server.parameters.settings import DEFAULTS, RULES, Settings
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    SetParametersResult,
)
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter


class Parameters:
    """
    The ROS parameters of a node; ``settings`` holds the values that are in force now.

    A change that breaks a rule is refused, and ``settings`` stays as it is.

    Parameters
    ----------
    node : Node
        The node on which the parameters are declared.
    on_change : callable
        Called with the new settings after at least one value has changed, before the caller that
        set the parameters gets its response.

    Raises
    ------
    SettingsError
        When a value that the node was started with has the wrong type or breaks its rule.

    """

    def __init__(self, node: Node, on_change: Callable[[Settings], None]) -> None:
        self._on_change = on_change
        self.settings = Settings(**{name: _declare(node, name) for name in RULES})
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._accept)

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        try:
            self._changed(parameters)
        except SettingsError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _accept(self, parameters: list[Parameter]) -> None:
        settings = self._changed(parameters)
        if settings != self.settings:
            self.settings = settings
            self._on_change(settings)

    def _changed(self, parameters: list[Parameter]) -> Settings:
        """Return the settings in force with ``parameters`` changed, or raise SettingsError."""
        values = {item.name: item.value for item in parameters if item.name in RULES}
        return dataclasses.replace(self.settings, **values)


def _declare(node: Node, name: str) -> Any:
    """Declare a parameter of ``Settings`` on ``node``; return its start value, or its default."""
    default = getattr(DEFAULTS, name)
    if isinstance(default, tuple):
        default = list(default)
    try:
        parameter = node.declare_parameter(name, default, _descriptor(RULES[name], default))
    except ParameterException as error:
        raise SettingsError(f"parameter '{name}': {error}") from error
    return parameter.value if parameter.value is not None else default


def _descriptor(rule: Rule, default: bool | int | float | str | list[str]) -> ParameterDescriptor:
    """Return the descriptor of a parameter: its meaning, and the range that rclpy enforces."""
    unit = f' [{rule.unit}]' if rule.unit else ''
    constraints = f'one of: {", ".join(rule.choices)}' if rule.choices else ''
    if rule.entries:
        constraints = f'each: {rule.entries}'
    descriptor = ParameterDescriptor(
        description=rule.description + unit,
        additional_constraints=constraints,
        read_only=rule.read_only,
    )
    if rule.lower is not None and rule.upper is not None:
        if isinstance(default, float):
            lower, upper = float(rule.lower), float(rule.upper)
            descriptor.floating_point_range = [
                FloatingPointRange(from_value=lower, to_value=upper, step=0.0)
            ]
        else:
            lower, upper = int(rule.lower), int(rule.upper)
            descriptor.integer_range = [IntegerRange(from_value=lower, to_value=upper, step=1)]
    return descriptor
