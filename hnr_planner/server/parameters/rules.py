"""Rules of parameters: the meaning, the unit and the allowed values of each one."""

import dataclasses
from dataclasses import dataclass
from typing import Any

from hnr_planner.core.errors import HnrError

#: Largest value of a parameter that is a distance [m].
LONGEST = 1000.0


class SettingsError(HnrError, ValueError):
    """A parameter was given a value that its rule does not allow."""


@dataclass(frozen=True)
class Rule:
    """
    The rule of one parameter.

    Parameters
    ----------
    description : str
        What the parameter means, for people.
    unit : str
        Unit of the value; empty for none.
    lower, upper : float, optional
        Smallest and largest allowed value; checked only when both are given.
    choices : tuple of str
        All allowed values; empty for no such restriction.
    read_only : bool
        Whether the value can be set only when the node starts.
    entries : str
        Form of each entry of a list, for people; empty for other parameters. Not checked here.

    """

    description: str
    unit: str = ''
    lower: float | None = None
    upper: float | None = None
    choices: tuple[str, ...] = ()
    read_only: bool = False
    entries: str = ''

    def check(self, name: str, value: Any) -> None:
        """Raise SettingsError when ``value`` is not allowed for the parameter ``name``."""
        if self.choices and value not in self.choices:
            names = ', '.join(self.choices)
            raise SettingsError(f'{name} must be one of {names}, got {value!r}')
        if self.lower is not None and self.upper is not None:
            if not self.lower <= value <= self.upper:
                unit = f' {self.unit}' if self.unit else ''
                allowed = f'{self.lower:.10g}..{self.upper:.10g}{unit}'
                raise SettingsError(f'{name} must be in {allowed}, got {value!r}')


def setting(default: Any, description: str, unit: str = '', **rule: Any) -> Any:
    """Return a dataclass field with ``default``, and with its ``Rule`` as metadata ``rule``."""
    metadata = {'rule': Rule(description, unit, **rule)}
    return dataclasses.field(default=default, metadata=metadata)


def distance(description: str) -> Any:
    """Return a field, as ``setting`` does, for a distance of 0 to 1000 m that is 0 by default."""
    return setting(0.0, description, 'm', lower=0.0, upper=LONGEST)
