"""Run OMPL's planners, in C++ and from PyPI, through pipes."""

from benchmarks.ompl.driver import (
    MissingOmpl,
    native,
    native_version,
    Session,
    wheel,
    wheel_version,
)

__all__ = ['MissingOmpl', 'Session', 'native', 'native_version', 'wheel', 'wheel_version']
