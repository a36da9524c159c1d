"""
The nodes under load and under faults: short with the other tests, long with ``make soak``.

Everything is bounded in count and time. What was measured is told at the end of the run.
"""
