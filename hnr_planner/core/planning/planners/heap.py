"""
Binary heaps in the arrays of a search: the node of the least estimate comes first.

A search is a NamedTuple with ``estimates`` (rows,), ``heap`` (rows,), the number of the node of
each estimate, and ``sizes``, whose entry ``N_OPEN`` is the number of nodes in the heap.
"""

from hnr_planner.core.kernels.kernel import inlined

#: Entries of ``sizes``: number of nodes in the heap; for ``take_first`` 1 where the heap has a
#: hole at its top, else 0.
N_OPEN, HAS_HOLE = 2, 5


@inlined
def add_open(search, estimate, row):
    """Insert a row in the heap: in the hole that ``take_first`` left, if any."""
    sizes = search.sizes
    if sizes[HAS_HOLE] == 0:
        push(search, estimate, row)
        return
    sizes[HAS_HOLE] = 0
    sizes[N_OPEN] += 1
    _sift_down(search, estimate, row)


@inlined
def take_first(search):
    """
    Return the row first in the heap, and remove it: it leaves a hole there.

    The next ``add_open`` fills the hole, at less cost than a removal and an insertion, since what
    follows a node often has the same estimate. ``close_hole`` has to be called before the next.
    """
    search.sizes[N_OPEN] -= 1
    search.sizes[HAS_HOLE] = 1
    return search.heap[0]


@inlined
def close_hole(search):
    """Fill the hole of the heap, if there is one, with its last entry."""
    sizes = search.sizes
    if sizes[HAS_HOLE] == 1:
        sizes[HAS_HOLE] = 0
        last = sizes[N_OPEN]
        _sift_down(search, search.estimates[last], search.heap[last])


@inlined
def push(search, estimate, row):
    """Insert a row in the heap, ordered by ``estimate``."""
    estimates, heap = search.estimates, search.heap
    k = search.sizes[N_OPEN]
    search.sizes[N_OPEN] += 1
    while k > 0 and estimates[(k - 1) // 2] > estimate:
        estimates[k], heap[k] = estimates[(k - 1) // 2], heap[(k - 1) // 2]
        k = (k - 1) // 2
    estimates[k], heap[k] = estimate, row


@inlined
def pop(search):
    """Remove the entry of the least estimate from the heap."""
    search.sizes[N_OPEN] -= 1
    last = search.sizes[N_OPEN]
    _sift_down(search, search.estimates[last], search.heap[last])


@inlined
def _sift_down(search, estimate, row):
    """Insert a row in a heap whose first entry is free, from there downwards."""
    estimates, heap, n = search.estimates, search.heap, search.sizes[N_OPEN]
    k = 0
    while 2 * k + 1 < n:
        child = 2 * k + 1
        if child + 1 < n and estimates[child + 1] < estimates[child]:
            child += 1
        if estimates[child] >= estimate:
            break
        estimates[k], heap[k] = estimates[child], heap[child]
        k = child
    estimates[k], heap[k] = estimate, row
