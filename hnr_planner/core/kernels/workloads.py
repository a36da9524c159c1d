"""Machine code that workloads need: found by running each workload once for these sources."""

from hnr_planner.core.kernels.kernel import calls_of
from hnr_planner.core.kernels.needs import keep_needs, known_needs, Need, need_of, Workload


def needs_of(workload: Workload) -> list[Need]:
    """
    Return the needs of a workload, from the cache folder if they are kept there.

    Else run the workload, interpreted where there is no machine code, and keep its needs.
    """
    known = known_needs(workload)
    if known is not None:
        return known
    needs = [need for call in calls_of(workload.run) if (need := need_of(*call)) is not None]
    keep_needs(workload, needs)
    return needs
