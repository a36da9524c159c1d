"""Return of memory to the operating system when a large map is replaced by a small one."""

import ctypes

#: glibc's number of the ``mallopt`` parameter for the size from which blocks are mapped.
M_MMAP_THRESHOLD = -3

#: Blocks of this size [bytes] or more are mapped one by one, and unmapped when they are freed.
LARGE_BLOCK = 1 << 20


def give_back_large_blocks() -> None:
    """
    Let the C library return each large block to the system when it is freed.

    By default glibc raises the size from which blocks are mapped one by one, up to 32 MiB, to
    that of each such block that is freed: the arrays of a second large map then lie in the heap,
    which cannot shrink while memory behind them is in use. In a C library without ``mallopt``
    nothing is changed.
    """
    libc = ctypes.CDLL(None)
    if hasattr(libc, 'mallopt'):
        libc.mallopt(M_MMAP_THRESHOLD, LARGE_BLOCK)
