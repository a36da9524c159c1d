"""
Copies between arrays that are cheap to compile.

Between arrays, ``a[:] = b`` and ``rows[k] = b`` cost a second or more of compilation in a kernel:
numba checks the shapes, and compiles the text of its error message with it. A loop costs a tenth,
and runs as fast.
"""

from hnr_planner.core.kernels.kernel import inlined


@inlined
def copy_into(target, source):
    """Write a vector (n,) into another one, which may be a row of a matrix."""
    for i in range(len(target)):
        target[i] = source[i]


@inlined
def copy_rows(target, source):
    """Write a matrix (m, n) into another one, which may be a slice of a larger one."""
    for k in range(target.shape[0]):
        for i in range(target.shape[1]):
            target[k, i] = source[k, i]
