"""
The walks that chains take: each a value, and its step a small kernel.

A walk is a frozen dataclass whose fields are its settings. For a space it gives a NamedTuple, by
whose type compiled code finds the step.

The uniform law on the start's part of the space is stationary for all of them, and each step can
be taken back with the same density (the paper's section 1; Lovasz and Simonovits, "Random walks in
a convex body and an improved volume algorithm", 1993, for the ball walk).
"""

from dataclasses import dataclass
import math
from typing import Any, NamedTuple, Protocol

from hnr_planner.core.checks import check_choice, check_positive
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.sampling.draws import draw_direction, draw_in_ball, REDRAWS_MAX
from hnr_planner.core.spaces.chain_cache import (
    chord_cached,
    move_along,
    move_if_free,
    NO_AXIS,
    refresh,
)
from hnr_planner.core.spaces.primitives import first_exit
from hnr_planner.core.spaces.space import Space

#: What is counted of a chain, by column: steps taken; those that moved it; chords shorter than the
#: space's margin; draws thrown away because they rounded onto the boundary; steps since it moved.
STEPS, MOVES, ZERO_CHORDS, REDRAWS, STILL = range(5)
N_COUNTS = 5


class Walk(Protocol):
    """A walk: a name, and what its step needs in a space."""

    @property
    def name(self) -> str:
        """Name in the table of walks."""

    def compiled(self, space: Space) -> Any:
        """Return the NamedTuple that the step is found by, lengths in the kernel frame."""


@dataclass(frozen=True)
class HitAndRunWalk:
    """A uniform direction, and a uniform point on the chord (paper, section 1)."""

    name = 'hit_and_run'

    def compiled(self, space: Space) -> Any:
        """Return what the step needs."""
        return HitAndRunStep(space.zero_length)


@dataclass(frozen=True)
class CoordinateHitAndRunWalk:
    """One of the axes, each as likely as the others, and a uniform point on the chord."""

    name = 'coordinate_hit_and_run'

    def compiled(self, space: Space) -> Any:
        """Return what the step needs."""
        return CoordinateHitAndRunStep(space.zero_length)


@dataclass(frozen=True)
class BallWalk:
    """
    A uniform point of a ball around the chain's, taken if it is free and otherwise not.

    The walk of textbooks looks at the end point alone, and steps through walls that are thinner
    than its radius. Where the segment has to be free as well, it moves as a robot could.

    Attributes
    ----------
    radius : float, optional
        Radius of the ball, in the caller's units. When left out, ``(dim + 1) / sqrt(dim)`` times
        the space's typical clearance: in a ball of radius r that is r / sqrt(dim), the largest, up
        to a factor, with which steps in high dimension are not mostly refused.
    segment_visible : bool
        Whether the segment to the new point must be free too.

    Raises
    ------
    RequestError
        When the radius is not above 0.

    """

    radius: float | None = None
    segment_visible: bool = True

    name = 'ball_walk'

    def __post_init__(self) -> None:
        if self.radius is not None:
            check_positive('radius', self.radius)

    def compiled(self, space: Space) -> Any:
        """Return what the step needs."""
        if self.radius is None:
            radius = space.typical_clearance * (space.dim + 1) / math.sqrt(space.dim)
        else:
            radius = float(self.radius) / space.scale
        return BallStep(radius, bool(self.segment_visible))


_WALKS: dict[str, Walk] = {
    walk.name: walk for walk in (HitAndRunWalk(), CoordinateHitAndRunWalk(), BallWalk())
}

#: Names of the walks, with their settings as they come.
WALKS = tuple(_WALKS)


def make_walk(walk: str | Walk) -> Walk:
    """Return the walk that a name or a value means, or raise RequestError."""
    if isinstance(walk, str):
        return _WALKS[check_choice('walk', walk, WALKS)]
    if isinstance(walk, type) or not callable(getattr(walk, 'compiled', None)):
        raise RequestError(f'walk must be one of {", ".join(WALKS)}, or a walk, got {walk!r}')
    return walk


class HitAndRunStep(NamedTuple):
    """Hit-and-Run for kernels: the length below which a chord counts as none."""

    margin: float


class CoordinateHitAndRunStep(NamedTuple):
    """Coordinate Hit-and-Run for kernels; likewise."""

    margin: float


class BallStep(NamedTuple):
    """The ball walk for kernels: its settings."""

    radius: float
    segment_visible: bool


@dispatched
@inlined
def take_step(walk: Any, space: Any, cache: Any, u: Any, rng: Any, counts: Any) -> None:
    """
    Move the chain at ``cache`` once, or leave it where it is, and count which.

    ``u`` (dim,) is room for a direction; it is zero before and after a step along an axis.
    """
    raise NotImplementedError


@take_step.register(HitAndRunStep)
@inlined
def _step_anywhere(walk, space, cache, u, rng, counts):
    draw_direction(rng, u)
    _draw_on_chord(walk.margin, space, cache, u, NO_AXIS, rng, counts)


@take_step.register(CoordinateHitAndRunStep)
@inlined
def _step_along_an_axis(walk, space, cache, u, rng, counts):
    axis = math.floor(uniform(rng) * len(u))
    u[axis] = 1.0
    _draw_on_chord(walk.margin, space, cache, u, axis, rng, counts)
    u[axis] = 0.0


@inlined
def _draw_on_chord(margin, space, cache, u, axis, rng, counts):
    lower, upper = chord_cached(space, cache, u, axis)
    if upper - lower >= margin:
        if _draw_between(space, cache, u, axis, lower, upper, rng, counts):
            _count_move(counts)
    else:
        _draw_on_zero_chord(space, cache, u, axis, lower, upper, rng, counts)


@inlined
def _draw_between(space, cache, u, axis, lower, upper, rng, counts):
    """Move uniformly on the chord; draws that round onto the boundary are drawn again."""
    for _ in range(REDRAWS_MAX):
        s = lower + (upper - lower) * uniform(rng)
        if lower < s < upper and move_along(space, cache, u, axis, s):
            return True
        counts[REDRAWS] += 1
    return False


@kernel
def _draw_on_zero_chord(space, cache, u, axis, lower, upper, rng, counts):
    """Draw on a chord that may be too short for any number but the point itself."""
    counts[ZERO_CHORDS] += 1
    before = cache.x.copy()
    _draw_between(space, cache, u, axis, lower, upper, rng, counts)
    for i in range(len(before)):
        if cache.x[i] != before[i]:
            _count_move(counts)
            return


@take_step.register(BallStep)
@inlined
def _step_in_the_ball(walk, space, cache, u, rng, counts):
    draw_in_ball(walk.radius, rng, u)
    for i in range(len(u)):
        cache.y[i] = cache.x[i] + u[i]
    if walk.segment_visible and not first_exit(space, cache.x, u, 0.0, 1.0) > 1.0:
        return
    if move_if_free(space, cache):
        refresh(space, cache)
        _count_move(counts)


@inlined
def _count_move(counts):
    counts[MOVES] += 1
    counts[STILL] = 0
