"""The rule of a parameter: its meaning, its unit, and the values it takes."""

import dataclasses
from dataclasses import dataclass
from typing import Any

from hnr_planner.core.errors import HnrError


class SettingsError(HnrError, ValueError):
    """A parameter was given a value that it cannot have."""


@dataclass(frozen=True)
class Rule:
    """Meaning of a parameter, and the values it takes."""

    description: str
    unit: str = ''
    lower: float | None = None
    upper: float | None = None
    choices: tuple[str, ...] = ()
    read_only: bool = False
    entries: str = ''

    def check(self, name: str, value: Any) -> None:
        """Raise SettingsError, with the value and the rule, when ``value`` breaks this rule."""
        if self.choices and value not in self.choices:
            names = ', '.join(self.choices)
            raise SettingsError(f'{name} must be one of {names}, got {value!r}')
        if self.lower is not None and self.upper is not None:
            if not self.lower <= value <= self.upper:
                unit = f' {self.unit}' if self.unit else ''
                allowed = f'{self.lower:.10g}..{self.upper:.10g}{unit}'
                raise SettingsError(f'{name} must be in {allowed}, got {value!r}')


def setting(default: Any, description: str, unit: str = '', **rule: Any) -> Any:
    """Return a field of a dataclass that carries its rule."""
    metadata = {'rule': Rule(description, unit, **rule)}
    return dataclasses.field(default=default, metadata=metadata)
