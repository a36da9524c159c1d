"""Kernels that tests of the tiers run: quick to compile, or never done, or not compilable."""

import os
from pathlib import Path
import time
from typing import Any, NamedTuple

from hnr_planner.core.kernels.dispatch import dispatched
from hnr_planner.core.kernels.kernel import kernel
from numba.extending import overload


class Pair(NamedTuple):
    """Something that a dispatched function knows."""

    one: float
    other: float


@kernel
def halved(x):
    """Return half of a number."""
    return x / 2.0


@kernel
def collatz(n):
    """Return how many steps of Collatz lead from ``n`` to 1."""
    steps = 0
    while n != 1:
        n = n // 2 if n % 2 == 0 else 3 * n + 1
        steps += 1
    return steps


@kernel
def mean_of_ratios(a, b):
    """Return the mean of ``a / b`` (n,), which may be inf or nan."""
    total = 0.0
    for i in range(len(a)):
        total += a[i] / b[i]
    return total / len(a)


@dispatched
@kernel
def total(_data: Any, factor: float) -> float:
    """Return a sum; 0 unless a type knows better."""
    return 0.0 * factor


@total.register(Pair)
@kernel
def _total_of_pair(pair, factor):
    return factor * (pair.one + pair.other)


@kernel
def first_of(pair):
    """Return the first number of a tuple of any type."""
    return pair[0]


def gate() -> float:
    """Return 1; compiling it leaves a mark in ``HNR_TEST_GATE``, and waits there for ``open``."""
    return 1.0


@overload(gate)
def _compiled_gate():
    folder = Path(os.environ['HNR_TEST_GATE'])
    (folder / f'compiled by {os.getpid()}').touch()
    while not (folder / 'open').exists():
        time.sleep(0.01)
    return lambda: 1.0


def someone_compiles_gated() -> bool:
    """Return whether a process has come to the gate."""
    return any(Path(os.environ['HNR_TEST_GATE']).glob('compiled by *'))


@kernel
def gated(x):
    """Return ``x``; it is compiled once the gate is open."""
    return x * gate()


@kernel
def uncompilable(x):
    """Return ``x`` as text, in a way that numba does not know."""
    return f'{x:{x}}' if x < 0 else vars()['x']


def use() -> None:
    """Make the calls of a use: a workload."""
    halved(1.0)
    collatz(6)
