"""Runs in the formats of other programs."""

from app.export.export import (
    AT_A_MOMENT,
    FORMATS,
    Choices,
    Format,
    Played,
    Progress,
    Window,
    at_a_moment,
    check_export,
    export_run,
    files_of,
)

__all__ = [
    "AT_A_MOMENT",
    "FORMATS",
    "Choices",
    "Format",
    "Played",
    "Progress",
    "Window",
    "at_a_moment",
    "check_export",
    "export_run",
    "files_of",
]
