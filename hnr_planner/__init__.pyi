from hnr_planner.core import *  # noqa: F403

__version__: str
