"""Refuse what memory cannot hold, before the machine is asked for it."""

from __future__ import annotations

from .errors import InputError

SMALL = 2**26
"""Bytes that are not worth a look."""


def require(size: float, what: str) -> None:
    """`what` takes `size` bytes.

    Raises:
        InputError: So many are not free.
    """
    if size < SMALL:
        return
    import psutil

    free = psutil.virtual_memory().available
    if size > free:
        raise InputError(
            f"{what} would take {size:.4g} bytes ({size / 2**30:.3g} GiB), {free / 2**30:.3g} GiB are free; take fewer"
        )
