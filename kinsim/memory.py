"""Refuse what memory cannot hold, before the machine is asked for it."""

from __future__ import annotations

from .errors import InputError

SMALL = 2**26
"""Bytes that are not worth a look."""

STATE = 32
"""Bytes that a cell takes in a state that is kept: h and q, once by themselves and once in the run."""

ROW = 4096
"""Bytes of a row of the ledger: its numbers, as Python keeps them."""

STEP = 40
"""Bytes of the length of a step, as Python keeps it and in the run."""


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


def require_history(rows: int, steps: int, cells: int, what: str) -> None:
    """A run of `steps` steps that keeps `rows` states of `cells` cells, with their rows in the ledger.

    Raises:
        InputError: Their memory is not free.
    """
    require(rows * (STATE * cells + ROW) + float(steps) * STEP, what)
