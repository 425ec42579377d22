"""Warnings of results that are formally right and physically doubtful."""

from typing import Any

ResultWarning = dict[str, Any]
"""``name``, ``message``, and figures whose units stand in their keys."""


def warning(name: str, message: str, **figures: Any) -> ResultWarning:
    """Return a warning; ``figures`` have their units in their keys."""
    return {"name": name, "message": message} | figures
