"""Run the command line: ``python -m hnr_planner``."""

import sys

from hnr_planner.cli.main import main

if __name__ == '__main__':
    sys.exit(main())
