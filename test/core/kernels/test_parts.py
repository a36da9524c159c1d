"""Parts: kernels that other kernels call are code of their callers, and nothing else."""

from hnr_planner.core.kernels.kernel import kernel
import numpy as np
import pytest


@kernel
def half(x):
    if x < 0.0:
        raise ValueError('below zero')
    return x / 2.0


@kernel
def quarter(x):
    return half(half(x))


@kernel
def sum_of_quarters(values):
    total = 0.0
    for value in values:
        total += quarter(value) + half(value) / 2.0
    return total


@kernel
def factorial(n):
    return n * factorial(n - 1) if n > 1 else 1


@kernel
def sum_of_factorials(numbers):
    total = 0
    for n in numbers:
        total += factorial(n)
    return total


def test_only_what_python_calls_becomes_machine_code():
    assert sum_of_quarters(np.array([1.0, 3.0])) == 2.0
    assert len(sum_of_quarters.overloads) == 1
    assert not half.overloads
    assert not quarter.overloads
    assert quarter(2.0) == 0.5
    assert len(quarter.overloads) == 1
    assert not half.overloads


def test_parts_raise_in_their_callers():
    with pytest.raises(ValueError, match='below zero'):
        sum_of_quarters(np.array([1.0, -1.0]))


def test_a_part_may_call_itself():
    assert sum_of_factorials(np.array([1, 3, 5])) == 127
    assert factorial(5) == 120
