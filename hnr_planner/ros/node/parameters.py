"""ROS parameters: declared from the table of `Settings`, and kept as one frozen copy of it."""

from collections.abc import Callable
import dataclasses
from typing import Any

from hnr_planner.server.settings import DEFAULTS, Rule, RULES, Settings, SettingsError
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
    The node's parameters; `settings` is what is in force now.

    Parameters
    ----------
    node : Node
        The parameters are declared on it.
    on_change : callable
        Called with the new settings after some were changed, before the caller that changed
        them gets its answer.

    Raises
    ------
    SettingsError
        When a value that the node was started with breaks its rule.

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
        """Return the settings with `parameters` applied, or raise SettingsError."""
        values = {item.name: item.value for item in parameters if item.name in RULES}
        return dataclasses.replace(self.settings, **values)


def _declare(node: Node, name: str) -> Any:
    """Declare one parameter and return its value."""
    try:
        parameter = node.declare_parameter(
            name, getattr(DEFAULTS, name), _descriptor(RULES[name], getattr(DEFAULTS, name))
        )
    except ParameterException as error:
        raise SettingsError(f"parameter '{name}': {error}") from error
    return parameter.value


def _descriptor(rule: Rule, default: bool | int | float | str) -> ParameterDescriptor:
    """Return what `ros2 param describe` shows, with the range that rclpy itself checks."""
    unit = f' [{rule.unit}]' if rule.unit else ''
    descriptor = ParameterDescriptor(
        description=rule.description + unit,
        additional_constraints=f'one of: {", ".join(rule.choices)}' if rule.choices else '',
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
