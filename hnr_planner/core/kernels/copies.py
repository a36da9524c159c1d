"""
Copies between arrays that are cheap to compile.

Between arrays, ``a[:] = b`` and ``rows[k] = b`` cost a second or more of compilation in a kernel:
numba checks the shapes, and compiles the text of its error message with it. A loop costs a tenth
of that to compile, and runs as fast.
"""

from typing import Any

from hnr_planner.core.kernels.kernel import inlined


@inlined
def copy_into(target, source):
    """
    Write the first n elements of ``source`` into ``target`` (n,).

    ``source`` has at least n elements; ``target`` may be a view of part of an array.
    """
    for i in range(len(target)):
        target[i] = source[i]


@inlined
def copy_rows(target, source):
    """
    Write the first m rows of ``source`` into ``target`` (m, n).

    ``source`` is at least (m, n); ``target`` may be a view of part of an array.
    """
    for k in range(target.shape[0]):
        for i in range(target.shape[1]):
            target[k, i] = source[k, i]


def _assign(target: Any, source: Any) -> None:
    target[...] = source[: len(target)]


# Interpreted, an assignment is the cheap one.
copy_into.interpreted_form = copy_rows.interpreted_form = _assign
