"""
Random walks: how a chain takes one step.

A walk is a frozen dataclass whose fields are its settings. ``compiled(space)`` turns it into a
NamedTuple of numbers in the kernel frame, and the type of that NamedTuple selects the kernel of
its step::

    take_step(walk, space, cache, u, rng, counts) -> moved

The kernel may change the chain's position in ``cache``, and returns whether the chain moved. The
result depends on the arguments only; module ``chains`` calls the kernel in a loop, and counts
steps and moves. To add a walk, write a dataclass, a NamedTuple, a kernel registered for that
NamedTuple, and an entry in ``_WALKS``.

The uniform distribution on the component of the start is stationary for every walk here, and every
step is reversible: its transition density is symmetric (paper, Section 1; for the ball walk:
Lovasz and Simonovits, "Random walks in a convex body and an improved volume algorithm", 1993).
"""

from dataclasses import dataclass
import math
from typing import Any, NamedTuple, Protocol

from hnr_planner.core.checks import check_choice, check_positive
from hnr_planner.core.errors import RequestError
from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.kernels.streams import uniform
from hnr_planner.core.sampling.draws import draw_in_ball, REDRAWS_MAX
from hnr_planner.core.spaces.chain_cache import (
    chord_cached,
    move_along,
    move_if_free,
    NO_AXIS,
    refresh,
)
from hnr_planner.core.spaces.lines import check_straight_lines, draw_direction
from hnr_planner.core.spaces.primitives import first_exit
from hnr_planner.core.spaces.space import Space

#: Counters of a chain, by column: steps taken; steps that moved it; chords shorter than the
#: space's zero length; draws rejected because they rounded onto the boundary; steps since the last
#: move.
STEPS, MOVES, ZERO_CHORDS, REDRAWS, STILL = range(5)
N_COUNTS = 5


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
    Hit-and-Run: draw a uniform direction, then a uniform point of the chord along it.

    The chord is the free segment through the chain's point (paper, Section 1).
    """

    name = 'hit_and_run'

    def compiled(self, space: Space) -> Any:
        """Return the settings for the kernel, lengths in the kernel frame."""
        return HitAndRunStep(space.zero_length)


@dataclass(frozen=True)
class CoordinateHitAndRunWalk:
    """Coordinate Hit-and-Run: draw a uniform axis, then a uniform point of the chord along it."""

    name = 'coordinate_hit_and_run'

    def compiled(self, space: Space) -> Any:
        """Return the settings for the kernel, lengths in the kernel frame."""
        check_straight_lines(space, f'the walk {self.name}')
        return CoordinateHitAndRunStep(space.zero_length)


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
        When the radius is not above 0.

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


class HitAndRunStep(NamedTuple):
    """Hit-and-Run for kernels: chords shorter than ``zero_length`` count as zero chords."""

    zero_length: float


class CoordinateHitAndRunStep(NamedTuple):
    """Coordinate Hit-and-Run for kernels: shorter chords than ``zero_length`` are zero chords."""

    zero_length: float


class BallStep(NamedTuple):
    """Ball walk for kernels: radius in the kernel frame, and whether segments must be free."""

    radius: float
    segment_visible: bool


@dispatched
@inlined
def take_step(walk: Any, space: Any, cache: Any, u: Any, rng: Any, counts: Any) -> bool:
    """
    Take one step of a walk, and return whether the chain moved.

    Parameters
    ----------
    walk : NamedTuple
        Compiled settings, whose type selects the kernel.
    space : NamedTuple
        Compiled space.
    cache : ChainCache or the space's own
        Position of the chain in the kernel frame, and what the space caches for it. The step
        changes both when the chain moves.
    u : (dim,)
        Work array for the direction; zero before and after steps of coordinate walks.
    rng : (4,) uint64
        Random stream of the chain.
    counts : (N_COUNTS,) int64
        Counters; the step adds to ``ZERO_CHORDS`` and ``REDRAWS`` only.

    """
    raise NotImplementedError


@take_step.register(HitAndRunStep)
@inlined
def _hit_and_run(walk, space, cache, u, rng, counts):
    """Move to a uniform point of the chord in a uniform direction; return whether it moved."""
    draw_direction(space, rng, u)
    return _move_on_chord(walk.zero_length, space, cache, u, NO_AXIS, rng, counts)


@take_step.register(CoordinateHitAndRunStep)
@inlined
def _coordinate_hit_and_run(walk, space, cache, u, rng, counts):
    """Move to a uniform point of the chord along a uniform axis; return whether it moved."""
    axis = math.floor(uniform(rng) * len(u))
    u[axis] = 1.0
    moved = _move_on_chord(walk.zero_length, space, cache, u, axis, rng, counts)
    u[axis] = 0.0
    return moved


@take_step.register(BallStep)
@inlined
def _ball_walk(walk, space, cache, u, rng, counts):
    """
    Move to a uniform point of the ball if it is free; return whether the chain moved.

    With ``walk.segment_visible`` the segment to the point must be free too.
    """
    draw_in_ball(walk.radius, rng, u)
    for i in range(len(u)):
        cache.y[i] = cache.x[i] + u[i]
    if walk.segment_visible and not first_exit(space, cache.x, u, 0.0, 1.0) > 1.0:
        return False
    if not move_if_free(space, cache):
        return False
    refresh(space, cache)
    return True


@inlined
def _move_on_chord(zero_length, space, cache, u, axis, rng, counts):
    """Move to a uniform point of the chord along ``u``; return whether the chain moved."""
    lower, upper = chord_cached(space, cache, u, axis)
    if upper - lower >= zero_length:
        return _move_between(space, cache, u, axis, lower, upper, rng, counts)
    return _move_on_zero_chord(space, cache, u, axis, lower, upper, rng, counts)


@inlined
def _move_between(space, cache, u, axis, lower, upper, rng, counts):
    """
    Move by ``s u``, with s uniform in (lower, upper); return whether the chain moved.

    A draw on an end, or whose point is not free, counts as a redraw and is repeated; after
    ``REDRAWS_MAX`` redraws the chain stays.
    """
    for _ in range(REDRAWS_MAX):
        s = lower + (upper - lower) * uniform(rng)
        if lower < s < upper and move_along(space, cache, u, axis, s):
            return True
        counts[REDRAWS] += 1
    return False


@kernel
def _move_on_zero_chord(space, cache, u, axis, lower, upper, rng, counts):
    """
    Move on a chord shorter than the zero length; return whether the position changed.

    Such a chord has few floating-point numbers, so that the point drawn may equal the old one.
    """
    counts[ZERO_CHORDS] += 1
    before = cache.x.copy()
    _move_between(space, cache, u, axis, lower, upper, rng, counts)
    for i in range(len(before)):
        if cache.x[i] != before[i]:
            return True
    return False
