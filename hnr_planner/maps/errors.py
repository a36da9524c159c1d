"""The error that a broken map file raises."""

from __future__ import annotations

from pathlib import Path

from hnr_planner.core.errors import HnrError


class MapFileError(HnrError, ValueError):
    """A map file cannot be read: the message names the file, the key, the value and the rule."""

    @classmethod
    def about(cls, path: Path, reason: str) -> MapFileError:
        """Join the file's path and the reason into one line."""
        return cls(f'{path}: {" ".join(reason.split())}')
