"""OMPL's planners in C++, behind a pipe."""

from benchmarks.ompl.driver import build, MissingOmpl, Session, version

__all__ = ['MissingOmpl', 'Session', 'build', 'version']
