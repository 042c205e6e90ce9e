"""What a run cannot go on from: numbers that are none, and those that no book could hold."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..balance.stages import Array
from ..kinetic.velocity import FASTEST
from ..stepper import Books
from .survey import Survey

LARGEST = float(np.finfo(float).max)


class Fault(NamedTuple):
    """What is wrong, and in which cell, if it is in one."""

    words: str
    cell: int | None = None


def room_beside(first: float, dx: float) -> float:
    """How large sums may become beside the mass in the beginning, to which they are compared."""
    return LARGEST * min(first or 1.0, 1.0) / (8.0 * max(dx, 1.0))


def find_fault(look: Survey, h: Array, q: Array, booked: Books, room: float) -> Fault | None:
    """Why a step to the state (h, q), each of shape (nx,), is not taken.

    `booked` is what the books would show then; neither they nor sums over the cells may go beyond `room`.
    """
    most = h.size * max(look.h_max, -look.h_min, look.q_max)
    if look.bad < 0 and look.fastest <= FASTEST and most < room and sum(map(abs, booked)) < room:
        return None
    if look.bad >= 0:
        return Fault("h or q is not finite", look.bad)
    if not look.fastest <= FASTEST:
        speed = np.abs(q) / np.where(h > 0.0, h, math.inf)
        return Fault(f"a velocity is beyond {FASTEST:g}", int(np.argmax(speed)))
    if not most < room:
        beside = "the mass or momentum of all cells is not finite, or not beside the mass of the start"
        return Fault(beside, int(np.argmax(np.maximum(np.abs(h), np.abs(q)))))
    parts = booked._asdict()
    worst = max(parts, key=lambda name: (not math.isfinite(parts[name]), abs(parts[name])))
    return Fault(f"the book {worst!r} is not finite, or not beside the mass of the start")
