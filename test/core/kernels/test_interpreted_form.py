"""Interpreted forms: arithmetic of machine code, loops that can be interrupted, own sources."""

import importlib.util
import itertools
import math
from pathlib import Path
from test.core.kernels.replays import same
from typing import Any

from hnr_planner.core.errors import Interrupted
from hnr_planner.core.kernels import interruption
from hnr_planner.core.kernels.interpreted_form import interpreted_form
from hnr_planner.core.kernels.interruption import interruptible
from hnr_planner.core.kernels.kernel import interpreted, kernel
import numpy as np
import pytest

#: Numbers on which Python raises, or rounds in another way than machine code.
AWKWARD = (0.0, -0.0, 1.0, -1.0, 0.1, -2.5, 1e-310, 1e200, -1e308, math.inf, -math.inf, math.nan)


@kernel
def quotients(a, b):
    """Return quotients of two numbers."""
    c = a
    c /= b
    return a / b, a // b, a % b, c


@kernel
def powers(a, b):
    """Return powers of a number."""
    return a**2, a**3, a**7, a**b, (a + b) ** 2, a**0


@kernel
def functions(a, b):
    """Return what the C library says of one or two numbers."""
    return (
        math.sqrt(a),
        math.log(a),
        math.exp(a),
        math.sin(a),
        math.cos(a),
        math.acos(a),
        math.atan(a),
        math.atan2(a, b),
        math.hypot(a, b),
        math.copysign(a, b),
    )


@kernel
def extremes(a, b):
    """Return the smaller and the larger number."""
    return min(a, b), max(a, b), min(max(a, 0.0), 1.0), abs(a)


@pytest.mark.parametrize('function', [quotients, powers, functions, extremes])
def test_arithmetic_on_awkward_numbers(function: Any):
    for a, b in itertools.product(AWKWARD, AWKWARD):
        assert same(function(a, b), interpreted(function)(a, b)), (a, b)


@pytest.mark.parametrize('function', [quotients, powers, functions, extremes])
def test_arithmetic_on_random_numbers(function: Any):
    """Plain Python is wrong in the last bit here once in some hundred numbers."""
    numbers = np.random.default_rng(1).normal(size=(3000, 2)) * 3.0
    for a, b in numbers.tolist():
        assert same(function(a, b), interpreted(function)(a, b)), (a, b)
    assert any(math.hypot(a, b) != functions(a, b)[8] for a, b in numbers.tolist())
    assert any(a**2 != powers(a, b)[0] for a, b in numbers.tolist())


@kernel
def whole_quotients(a, b):
    """Return quotients of two whole numbers."""
    return a // b, a % b, a / b


@pytest.mark.parametrize(('a', 'b'), [(7, 2), (-7, 2), (7, -2), (7, 0), (0, 0), (-7, 0)])
def test_arithmetic_on_whole_numbers(a: int, b: int):
    assert same(whole_quotients(a, b), interpreted(whole_quotients)(a, b))


@kernel
def sums(x):
    """Return sums of (n,) numbers."""
    return x.sum(), (x > 0.0).sum()


def test_sums_go_from_left_to_right():
    x = np.random.default_rng(2).normal(size=1000)
    assert same(sums(x), interpreted(sums)(x))
    assert x.sum() != sums(x)[0]


@kernel
def scaled(x, n):
    """Divide (n,) numbers in place, as a whole and one by one; return one that was taken out."""
    y = x
    y /= n
    x[0] /= 0.0
    taken = x[1]
    taken /= 0.0
    return taken


def test_division_in_place_changes_the_array():
    compiled, plain = np.array([1.0, 2.0, -4.0]), np.array([1.0, 2.0, -4.0])
    assert same(scaled(compiled, 4.0), interpreted(scaled)(plain, 4.0))
    assert plain.tolist() == compiled.tolist() == [math.inf, 0.5, -1.0]


# -- interruption ---------------------------------------------------------------------------------


@kernel
def count_for_ever(x):
    """Never return."""
    while True:
        x[0] += 1


@kernel
def count_up(x, n):
    """Count to a number so large that nobody lives to see it."""
    for _ in range(n):
        x[0] += 1


@kernel
def ask_another(x, n):
    """Leave the work to another kernel."""
    count_up(x, n)


@pytest.mark.parametrize(
    ('function', 'arguments'),
    [(count_for_ever, ()), (count_up, (2**62,)), (ask_another, (2**62,))],
)
def test_a_loop_ends_soon_after_its_condition_holds(
    function: Any, arguments: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(interruption, 'CHECK_INTERVAL', 0.0)
    turns = np.zeros(1, dtype=np.int64)
    with interruptible(lambda: turns[0] >= 1000), pytest.raises(Interrupted):
        interpreted(function)(turns, *arguments)
    assert turns[0] == 1000


# -- sources --------------------------------------------------------------------------------------

SOURCE = """
import math
from hnr_planner.core.kernels.kernel import kernel

def factor(n):
    @kernel
    def times(x):
        return n * math.hypot(x, 2.0) / 0.0 if x < 0.0 else n * x
    return times

double = factor(2.0)
"""


@pytest.fixture
def module(tmp_path: Path) -> Any:
    """Return a module from a file that a test may edit."""
    file = tmp_path / 'kernels_of_a_test.py'
    file.write_text(SOURCE)
    spec = importlib.util.spec_from_file_location('kernels_of_a_test', file)
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def test_a_kernel_keeps_what_it_closes_over(module: Any):
    assert interpreted(module.double)(3.0) == 6.0
    assert interpreted(module.double)(-3.0) == math.inf


def test_a_file_that_was_edited_since_changes_nothing(module: Any):
    file = Path(module.__file__)
    file.write_text(SOURCE.replace('n * x', 'n + x + 1.0'))
    form = interpreted_form(module.double.py_func)
    assert form(3.0) == 6.0


def test_tracebacks_name_the_line(module: Any):
    with pytest.raises(TypeError) as caught:
        interpreted(module.double)('text')
    assert caught.traceback[-1].lineno + 1 == 1 + SOURCE.splitlines().index(
        '        return n * math.hypot(x, 2.0) / 0.0 if x < 0.0 else n * x'
    )
