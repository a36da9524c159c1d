"""Memory that a large map took, given back to the system when a small one comes."""

import ctypes

#: The parameter of ``mallopt`` that is the threshold, as glibc numbers it.
M_MMAP_THRESHOLD = -3

#: Blocks of so many bytes or more are mapped one by one, and unmapped when they are freed.
LARGE_BLOCK = 1 << 20


def give_back_large_blocks() -> None:
    """
    Let the C library return each large block to the system when it is freed.

    By itself glibc raises the threshold, up to 32 MiB, to the size of each block that is freed:
    arrays of a second large map then lie in the heap, which cannot shrink below what is in use
    behind them. A C library without ``mallopt`` is left as it is.
    """
    libc = ctypes.CDLL(None)
    if hasattr(libc, 'mallopt'):
        libc.mallopt(M_MMAP_THRESHOLD, LARGE_BLOCK)
