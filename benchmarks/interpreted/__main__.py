"""
How late work ends, as JSON: ``python -m benchmarks.interpreted MAP RUNS``.

It is run with ``HNR_PLANNER_KERNELS=interpreted``.
"""

import json
import sys

from benchmarks.interpreted.work import measure

if __name__ == '__main__':
    json.dump(list(measure(sys.argv[1], int(sys.argv[2]))), sys.stdout)
