"""Exception and warning classes for map files that cannot be read or repeat a key."""

from __future__ import annotations

from pathlib import Path

from hnr_planner.core.errors import HnrError


class MapFileError(HnrError, ValueError):
    """
    Error that a map file cannot be read.

    The message names the file and the reason: for a key, its name, its value and the rule.
    """

    @classmethod
    def about(cls, path: Path, reason: str) -> MapFileError:
        """Return the error with the message ``path: reason`` in one line."""
        return cls(f'{path}: {" ".join(reason.split())}')


class MapFileWarning(UserWarning):
    """Warning that a key occurs repeatedly in a map file; the message names file and key."""
