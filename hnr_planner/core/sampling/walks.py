"""
Random walks: what a chain draws from, and by which steps.

A walk is a frozen dataclass whose fields are its settings. ``compiled(space)`` turns it into a
NamedTuple of numbers in the kernel frame, and the type of that NamedTuple selects the kernel of
its step (modules ``steps`` and ``density_steps``). To add a walk, write a dataclass, a NamedTuple,
a kernel registered for that NamedTuple, and an entry in ``_WALKS``.

Every walk here keeps the uniform distribution on the component of the start, or the density that
it is given there. Every step but an overrelaxed one is reversible: its transition density is
symmetric (paper, Section 1; for the ball walk: Lovasz and Simonovits, "Random walks in a convex
body and an improved volume algorithm", 1993).
"""

from collections.abc import Callable
from dataclasses import dataclass
import math
from typing import Any, Protocol

from hnr_planner.core.checks import check_choice, check_positive
from hnr_planner.core.errors import RequestError
from hnr_planner.core.sampling.density_steps import CompiledDensity
from hnr_planner.core.sampling.steps import (
    BallStep,
    CoordinateHitAndRunStep,
    HitAndRunStep,
    OverrelaxedStep,
)
from hnr_planner.core.spaces.lines import check_straight_lines
from hnr_planner.core.spaces.space import Space


class Walk(Protocol):
    """A random walk: its name, and the compiled form of its settings."""

    @property
    def name(self) -> str:
        """Name in ``WALKS``."""

    def compiled(self, space: Space) -> Any:
        """Return the NamedTuple that selects the step's kernel, lengths in the kernel frame."""


@dataclass(frozen=True)
class HitAndRunWalk:
    """
    Hit-and-Run: draw a uniform direction, then a point of the chord along it.

    The chord is the free segment through the chain's point (paper, Section 1). The point is
    uniform, or drawn from a density on the chord: exactly for a ``Gaussian`` and an
    ``Exponential``, by slice sampling for any other.

    Attributes
    ----------
    log_density : callable, optional
        The logarithm of a density, up to a constant: a function of a point (dim,) in the caller's
        frame, compiled by numba or in Python, whose values are below inf. It is -inf where there
        is no density. A function in Python is called from many threads, one at a time.

    Raises
    ------
    RequestError
        When the log-density is not callable.

    """

    log_density: Callable[[Any], float] | None = None

    name = 'hit_and_run'

    def __post_init__(self) -> None:
        density = None if self.log_density is None else CompiledDensity(self.log_density)
        object.__setattr__(self, '_density', density)

    def __reduce__(self) -> Any:
        """Pickle the log-density alone: its compiled form has an address of this process."""
        return type(self), (self.log_density,)

    def compiled(self, space: Space) -> Any:
        """Return the settings for the kernel, lengths in the kernel frame."""
        density: CompiledDensity | None = self._density  # type: ignore[attr-defined]
        return HitAndRunStep(space.zero_length) if density is None else density.step(space)

    def check_start(self, point: Any) -> None:
        """Raise RequestError where the density is not above 0 at ``point`` (dim,)."""
        density: CompiledDensity | None = self._density  # type: ignore[attr-defined]
        if density is not None:
            density.check_start(point)


@dataclass(frozen=True)
class CoordinateHitAndRunWalk:
    """
    Coordinate Hit-and-Run: draw a uniform axis, then a uniform point of the chord along it.

    Attributes
    ----------
    overrelaxed : bool
        Whether to take the axes in turn, and to move in four of five steps to the mirror image of
        the point on its chord instead of to a uniform point. Both suppress the random walk in
        long directions (Adler, "Over-relaxation method for the Monte Carlo evaluation of the
        partition function for multiquadratic actions", 1981): it takes several times fewer steps
        to an independent draw, and the chain is no longer reversible.

    """

    overrelaxed: bool = False

    name = 'coordinate_hit_and_run'

    def compiled(self, space: Space) -> Any:
        """Return the settings for the kernel, lengths in the kernel frame."""
        check_straight_lines(space, f'the walk {self.name}')
        step = OverrelaxedStep if self.overrelaxed else CoordinateHitAndRunStep
        return step(space.zero_length)


@dataclass(frozen=True)
class BallWalk:
    """
    Ball walk: draw a uniform point of the ball around the chain's point; move there if free.

    With ``segment_visible`` (the default) the segment to the new point must be free too, as for a
    robot. Without it, as in the textbook version, the new point alone is tested, so that the walk
    steps through walls that are thinner than its radius.

    Attributes
    ----------
    radius : float, optional
        Radius of the ball, in the caller's units. When left out, ``(dim + 1) / sqrt(dim)`` times
        the space's typical clearance. If the space is a ball of radius r, that is r / sqrt(dim):
        up to a factor, the largest radius whose steps are not mostly rejected in high dimensions.
    segment_visible : bool
        Whether the segment to the new point must be free too.

    Raises
    ------
    RequestError
        When the radius is not above 0, or the space does not keep lengths.

    """

    radius: float | None = None
    segment_visible: bool = True

    name = 'ball_walk'

    def __post_init__(self) -> None:
        if self.radius is not None:
            check_positive('radius', self.radius)

    def compiled(self, space: Space) -> Any:
        """Return the settings for the kernel, lengths in the kernel frame."""
        check_straight_lines(space, f'the walk {self.name}')
        if self.radius is None:
            radius = space.typical_clearance * (space.dim + 1) / math.sqrt(space.dim)
        else:
            if not space.is_rigid:
                raise RequestError(
                    f'a radius has no meaning in {space!r}, whose walks run in coordinates of '
                    f'their own; leave it out'
                )
            radius = float(self.radius) / space.scale
        return BallStep(radius, bool(self.segment_visible))


_WALKS: dict[str, Walk] = {
    walk.name: walk for walk in (HitAndRunWalk(), CoordinateHitAndRunWalk(), BallWalk())
}

#: Names of the walks with their default settings.
WALKS = tuple(_WALKS)


def make_walk(walk: str | Walk) -> Walk:
    """
    Return the walk of a name in ``WALKS``, or ``walk`` itself if it is a walk already.

    Raises
    ------
    RequestError
        For any other name or value, as for the class of a walk.

    """
    if isinstance(walk, str):
        return _WALKS[check_choice('walk', walk, WALKS)]
    if isinstance(walk, type) or not callable(getattr(walk, 'compiled', None)):
        raise RequestError(f'walk must be one of {", ".join(WALKS)}, or a walk, got {walk!r}')
    return walk
