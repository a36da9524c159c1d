"""
Plan paths on occupancy maps by Hit-and-Run and RRT: a ROS 2 node and the library under it.

``from hnr_planner import GridSpace, plan, sample``: the public names are those of
``hnr_planner.core``, and are loaded when they are first used.
"""

from typing import Any

from hnr_planner import core

__version__ = '0.2.0'
__all__ = core.__all__


def __getattr__(name: str) -> Any:
    """Return a public name of the core."""
    if name not in __all__:
        raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
    return getattr(core, name)


def __dir__() -> list[str]:
    """Return the names of this module, those of the core included."""
    return sorted({*globals(), *__all__})
