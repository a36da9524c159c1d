"""The error and the warning that map files give."""

from __future__ import annotations

from pathlib import Path

from hnr_planner.core.errors import HnrError


class MapFileError(HnrError, ValueError):
    """A map file cannot be read: the message names the file, the key, the value and the rule."""

    @classmethod
    def about(cls, path: Path, reason: str) -> MapFileError:
        """Return the error with the file's path and the reason in one line."""
        return cls(f'{path}: {" ".join(reason.split())}')


class MapFileWarning(UserWarning):
    """A key of a map file occurs repeatedly; the message names the file and the key."""
