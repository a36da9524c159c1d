"""
A client that asks and then dies without a word: ``python -m test.ros.soak.vanishing N_REQUESTS``.

It says ``asked`` when its requests are out; killing it is up to whoever started it.
"""

import sys
from test.ros.soak.callers import Caller
from test.ros.soak.worlds import END, plan_request, START
import time


def main(n_requests: int) -> None:
    """Ask for what takes long, and wait for ever."""
    caller = Caller()
    for _ in range(n_requests):
        caller.send(plan_request(START, END))
    print('asked', flush=True)
    time.sleep(600.0)


if __name__ == '__main__':
    main(int(sys.argv[1]))
