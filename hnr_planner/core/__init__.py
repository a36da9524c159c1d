"""
The algorithms, free of ROS: spaces, walks on them, and planners.

The module of a public name is imported when the name is first used, so that importing this package
alone costs nothing. The package ``hnr_planner`` has the same public names.

>>> space = GridSpace.from_blocked(np.zeros((20, 20), bool), resolution=0.5)
>>> plan(space, start=(1, 1), goal=(9, 9), seed=0).status
<PlannerStatus.SOLVED: 'a path was found'>
"""

from importlib import import_module
from pathlib import Path
import re
from typing import Any

#: Module that defines each public name. The names are listed in ``__init__.pyi`` alone, where type
#: checkers and editors see them too: one import statement for each.
_MODULE_OF = {
    name: module
    for module, name in re.findall(
        r'^from ([\w.]+) import \(?\s*(\w+) as',
        Path(__file__).with_suffix('.pyi').read_text(),
        re.M,
    )
}

__all__ = sorted(_MODULE_OF)


def __getattr__(name: str) -> Any:
    """Return the object of a public name: import its module, and keep the object for later."""
    if name not in _MODULE_OF:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    value = getattr(import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the names of this module, and the public names that are not loaded yet."""
    return sorted({*globals(), *__all__})
