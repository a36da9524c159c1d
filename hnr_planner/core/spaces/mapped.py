"""The image of a space under a map of the user that keeps volume."""

from collections.abc import Callable
from functools import cached_property
import math
from typing import Any, NamedTuple

from hnr_planner.core.checks import check_point, check_real, Floats
from hnr_planner.core.errors import SpaceError
from hnr_planner.core.kernels.kernel import inlined, kernel
from hnr_planner.core.lengths import norm
from hnr_planner.core.spaces.bounds import box_span, check_bounds
from hnr_planner.core.spaces.callbacks import address, ask, OracleError, vector_callback
from hnr_planner.core.spaces.primitives import (
    component,
    contains,
    first_entry,
    first_exit,
    touches,
)
from hnr_planner.core.spaces.search import entry_by_search, exit_by_search, is_in, work_size
from hnr_planner.core.spaces.space import CLOSENESS, ENTRY_STEPS, MARGIN, Space
import numpy as np
from numpy.typing import ArrayLike

#: Number of points of the base at which the map is checked.
CHECKS = 64
#: Number of chords of the base whose ends are mapped for the bounds.
RAYS = 2000
#: Width that is added to the bounds on every side, as a fraction of their sides.
AROUND = 0.5
#: Error of the inverse, as a fraction of the bounds' diagonal, and of the determinant of the
#: Jacobian, up to which the map passes the check.
INVERSE_ERROR, VOLUME_ERROR = 1e-6, 1e-3
#: Step of the difference quotients of the Jacobian, as a fraction of the bounds' diagonal.
DIFFERENCE = 1e-6


class MappedData(NamedTuple):
    """
    A compiled space under a map, in the caller's frame.

    Attributes
    ----------
    base : NamedTuple
        The compiled base, in its caller's frame.
    inverse : int
        Address of the inverse of the map.
    lower, upper : (dim,)
        Corners of a box around the image.
    resolution : float
        Distance between two consecutive points of a line that are tested.
    closeness : float
        Distance within which the end of a chord is located.

    """

    base: Any
    inverse: int
    lower: Floats
    upper: Floats
    resolution: float
    closeness: float


class MappedSpace(Space):
    """
    The image of a space under a one-to-one map that keeps volume, such as a twist.

    Uniform points of the base go to uniform points of the image: with a convex base, this is the
    paper's Assumption 2. Lines are searched: the point of the base is tested at every
    ``resolution`` along a line of the image, and a change is located by bisection. So a gap or a
    wall that is thinner than the resolution along a line may be missed.

    The map and its inverse are checked at some points of the base. Functions compiled by
    ``numba.njit`` are called as fast as any compiled code; one in Python costs some microseconds
    for each point. A space can be pickled when its functions can.

    Parameters
    ----------
    function, inverse : callable
        The map from points (dim,) of the base to points (dim,), and its inverse.
    base : Space
        The space that is mapped.
    resolution : float, optional
        Distance between two points of a line that are tested. When left out, a thousandth of the
        diagonal of the bounds.
    lower, upper : (dim,), optional
        Corners of a box that holds the image. When left out, the box around the images of points
        of the base, most of them on its boundary, widened by half on every side.

    Raises
    ------
    SpaceError
        When a function returns no points, ``inverse`` is not the inverse, or the map does not
        keep volume.

    Attributes
    ----------
    function, inverse, base, resolution
        As above.

    """

    data: MappedData

    def __init__(
        self,
        function: Callable[[Floats], Any],
        inverse: Callable[[Floats], Any],
        base: Space,
        *,
        resolution: float | None = None,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
    ) -> None:
        for name, given in (('function', function), ('inverse', inverse)):
            if not callable(given):
                raise SpaceError(f'{name} must be a function, got {given!r}')
        if not isinstance(base, Space):
            raise SpaceError(f'base must be a space, got {base!r}')
        self.function, self.inverse, self.base, self.dim = function, inverse, base, base.dim
        points, ends = _points_of(base)
        images = np.array([self._image(x) for x in (*points, *ends)])
        low, high = images.min(axis=0), images.max(axis=0)
        rim = AROUND * (high - low)
        self._lower = low - rim if lower is None else check_point('lower', lower, self.dim)
        self._upper = high + rim if upper is None else check_point('upper', upper, self.dim)
        check_bounds('the mapped space', self._lower, self._upper)
        diagonal = float(np.linalg.norm(high - low))
        self.resolution = diagonal / ENTRY_STEPS
        if resolution is not None:
            self.resolution = check_real('resolution', resolution, SpaceError)
        if not CLOSENESS * MARGIN * diagonal < self.resolution < math.inf:
            raise SpaceError(f'resolution must be above 0 and finite, got {resolution!r}')
        self._check_map(points, diagonal)
        self._compile()

    def _compile(self) -> None:
        """Make the compiled space, from functions that kernels call by address."""
        self._called_back = vector_callback(self.inverse)
        diagonal = float(np.linalg.norm(self._upper - self._lower))
        self.data = MappedData(
            self.base.compiled,
            address(self._called_back),
            self._lower,
            self._upper,
            self.resolution,
            CLOSENESS * MARGIN * diagonal,
        )

    def __getstate__(self) -> dict[str, Any]:
        """Leave out what holds an address of this process."""
        state = super().__getstate__()
        return {k: v for k, v in state.items() if k not in ('data', '_called_back')}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Compile the space again."""
        self.__dict__.update(state)
        self._compile()

    def __repr__(self) -> str:
        """Name the base and the resolution."""
        return f'MappedSpace(base={self.base!r}, resolution={self.resolution:g})'

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Lower and upper corner (dim,) of a box around the image, caller's frame."""
        return self._lower.copy(), self._upper.copy()

    @cached_property
    def typical_clearance(self) -> float:
        """Typical clearance of the base."""
        return self.base.typical_clearance * self.base.scale

    def why_not_free(self, point: ArrayLike) -> str:
        """Return the reason why ``point`` (dim,) is not free."""
        preimage = np.asarray(self.inverse(check_point('point', point, self.dim)))
        return f'mapped back, {self.base.why_not_free(preimage)}'

    def _image(self, point: Floats) -> Floats:
        """Return the image (dim,) of a point of the base; raise SpaceError if it is none."""
        image = np.asarray(self.function(point.copy()), dtype=np.float64)
        if image.shape != (self.dim,) or not np.isfinite(image).all():
            raise SpaceError(
                f'function must return finite points ({self.dim},), got {image.tolist()} for '
                f'{point.tolist()}'
            )
        return image

    def _check_map(self, points: Floats, diagonal: float) -> None:
        """Raise SpaceError where the inverse is none, or volume changes, at points (k, dim)."""
        step = DIFFERENCE * float(np.linalg.norm(np.subtract(*self.base.bounds)))
        for x in points:
            back = np.asarray(self.inverse(self._image(x)), dtype=np.float64)
            if back.shape != x.shape or not np.linalg.norm(back - x) <= INVERSE_ERROR * diagonal:
                raise SpaceError(
                    f'inverse must lead back: {x.tolist()} is mapped to '
                    f'{self._image(x).tolist()}, and from there to {back.tolist()}'
                )
            columns = [
                (self._image(x + e) - self._image(x - e)) / (2.0 * step)
                for e in step * np.eye(self.dim)
            ]
            volume = abs(float(np.linalg.det(np.array(columns))))
            if not abs(volume - 1.0) <= VOLUME_ERROR:
                raise SpaceError(
                    f'function must keep volume, but multiplies it by {volume:.4g} at {x.tolist()}'
                )


def _points_of(base: Space) -> tuple[Floats, Floats]:
    """Return free points (k, dim) of a space, and ends (n, dim) of chords through them."""
    rng = np.random.default_rng(0)
    lower, upper = base.bounds
    points = np.empty((0, base.dim))
    for _ in range(100):
        candidates = rng.uniform(lower, upper, (100 * CHECKS, base.dim))
        points = np.vstack([points, candidates[base.contains(candidates)]])
        if len(points) >= CHECKS:
            break
    if len(points) == 0:
        raise SpaceError(f'no free point of {base!r} was found to check the map at')
    points = points[:CHECKS]
    ends = []
    for k in range(RAYS):
        x, u = points[k % len(points)], rng.standard_normal(base.dim)
        low, high = base.chord(x, u)
        # Just inside, where the map is defined.
        ends += [x + (1.0 - MARGIN) * s * u for s in (low, high)]
    return points, np.array(ends)


@contains.register(MappedData)
@touches.register(MappedData)
@kernel
def _contains(mapped, x):
    """Return whether ``x`` (dim,), mapped back, is free in the base."""
    return is_in(mapped, x, x, 0.0, np.empty(2 * len(x)))


@first_exit.register(MappedData)
@kernel
def _first_exit(mapped, x, u, t, horizon):
    """Return the first parameter from ``t`` on at which a search finds the line outside."""
    _, last = box_span(mapped.lower, mapped.upper, x, u)
    if not is_in(mapped, x, u, t, np.empty(2 * len(x))):
        return t
    length = norm(u)
    step, closeness = mapped.resolution / length, mapped.closeness / length
    return exit_by_search(mapped, x, u, t, horizon, last, step, closeness)


@first_entry.register(MappedData)
@kernel
def _first_entry(mapped, x, u, t):
    """Return the first parameter from ``t`` on at which a search finds the line inside, or inf."""
    if is_in(mapped, x, u, t, np.empty(2 * len(x))):
        return t
    first, last = box_span(mapped.lower, mapped.upper, x, u)
    length = norm(u)
    step, closeness = mapped.resolution / length, mapped.closeness / length
    return entry_by_search(mapped, x, u, max(t, first), last, step, closeness)


@component.register(MappedData)
@kernel
def _component(mapped, x):
    """Return the component of the base, from 1, that holds the preimage of ``x``; 0 for none."""
    if not contains(mapped, x):
        return 0
    preimage = np.empty(len(x))
    if ask(mapped.inverse, x, preimage) != 0:
        raise OracleError
    return component(mapped.base, preimage)


@work_size.register(MappedData)
@inlined
def _work_size(mapped, dim):
    """Return the length of the work array: for a point, and for its preimage."""
    return 2 * dim


@is_in.register(MappedData)
@kernel
def _is_in(mapped, x, u, s, work):
    """Return whether ``x + s u`` is within the bounds and, mapped back, free in the base."""
    n = len(x)
    for i in range(n):
        work[i] = x[i] + s * u[i] if s != 0.0 else x[i]
        if not mapped.lower[i] < work[i] < mapped.upper[i]:
            return False
    point, preimage = work[:n], work[n:]
    if ask(mapped.inverse, point, preimage) != 0:
        raise OracleError
    return contains(mapped.base, preimage)
