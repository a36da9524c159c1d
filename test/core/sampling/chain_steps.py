"""One step of a walk of the package, from each of many points."""

from collections.abc import Callable

from hnr_planner.core import Space
from hnr_planner.core.checks import Floats
from hnr_planner.core.kernels.kernel import kernel
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.sampling.chain import new_chain
from hnr_planner.core.sampling.steps import take_step
from hnr_planner.core.sampling.walks import make_walk, Walk
from hnr_planner.core.spaces.chain_cache import open_cache, refresh
import numpy as np

Step = Callable[[Floats, np.random.Generator], Floats]


def step_of(walk: str | Walk, space: Space, n_steps: int = 1) -> Step:
    """Return the function that moves points (k, dim), caller's frame, by steps of a walk."""
    compiled = make_walk(walk).compiled(space)

    def step(points: Floats, rng: np.random.Generator) -> Floats:
        moved = space.to_kernel(points)
        chain = new_chain(space, moved[0].copy(), stream(int(rng.integers(2**63))))
        u = np.zeros(space.kernel_dim)
        _step_from_each(space.data, compiled, moved, chain, u, n_steps)
        return space.from_kernel(moved)

    return step


@kernel
def _step_from_each(space, walk, points, chain, u, n_steps):
    for k in range(len(points)):
        cache = open_cache(space, points[k], chain.memory)
        refresh(space, cache)
        for _ in range(n_steps):
            take_step(walk, space, cache, u, chain.rng, chain.counts)
