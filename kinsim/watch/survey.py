"""A look over a state: extremes, and whether all of it is finite."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..balance.stages import LANES, Array, largest
from ..kernel import kernel, kernel_relaxed
from ..local import Local, at

ROOM = np.empty((5, LANES))
"""What `look_over` works in; kernels hold the interpreter's lock, so that one room serves all threads."""


class Survey(NamedTuple):
    """Extremes of a state, and the first cell that is not finite, or -1."""

    h_min: float
    u_max: float
    fastest: float
    q_max: float
    h_max: float
    bad: int

    @classmethod
    def of(cls, h: Array, q: Array, beta: Local) -> Survey:
        """Of the state (h, q), each of shape (nx,); without extremes where it is not finite."""
        return cls(*look_over(h, q, beta, ROOM))


@kernel_relaxed("reassoc", "nsz")
def all_finite(h: Array, q: Array) -> bool:
    """Whether no entry is infinite or NaN: such a number times 0 is not 0."""
    total = 0.0
    for i in range(np.uint64(h.size)):
        total += 0.0 * h[i] + 0.0 * q[i]
    return total == 0.0


@kernel
def look_over(h: Array, q: Array, beta: Local, room: Array) -> tuple[float, float, float, float, float, int]:
    """The entries of a `Survey`; `room`, shape (5, LANES), keeps as many extremes of each kind side by side."""
    if not all_finite(h, q):
        for i in range(h.size):
            if not (np.isfinite(h[i]) and np.isfinite(q[i])):
                return np.inf, 0.0, 0.0, 0.0, 0.0, i
    low, deep, much, quick, far = room[0], room[1], room[2], room[3], room[4]
    for lane in range(low.size):
        low[lane], deep[lane], much[lane], quick[lane], far[lane] = -np.inf, 0.0, 0.0, 0.0, 0.0
    for begin in range(0, h.size, low.size):
        first, last = np.uint64(begin), np.uint64(min(begin + low.size, h.size))
        for i in range(first, last):
            k = i - first
            low[k] = max(low[k], -h[i])
            deep[k] = max(deep[k], h[i])
            much[k] = max(much[k], abs(q[i]))
        for i in range(first, last):
            k = i - first
            u = abs(q[i]) / h[i] if h[i] > 0.0 else 0.0
            quick[k] = max(quick[k], u)
            far[k] = max(far[k], u + np.sqrt(2.0 * at(beta, i) * max(h[i], 0.0)))
    return -largest(low), largest(quick), largest(far), largest(much), largest(deep), -1
