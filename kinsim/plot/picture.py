"""Where a picture goes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..store import check_destination, replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "pdf", "svg")
"""What a picture may be, by its suffix."""


def check_picture(path: str | Path) -> Path:
    """`path`, if a picture can be put there.

    Raises:
        InputError: Its suffix names no kind of picture, or no file can be put there.
    """
    path = Path(path)
    if path.suffix[1:].lower() not in FORMATS:
        raise InputError(f"{path}: is no picture; end its name in .{', .'.join(FORMATS)}")
    return check_destination(path)


def save(figure: Figure, path: str | Path) -> Path:
    """Write `figure` to a PNG, PDF or SVG file, all of it or nothing."""
    path = check_picture(path)
    with replacing(path) as name:
        figure.savefig(name, format=path.suffix[1:].lower(), dpi=150)
    return path
