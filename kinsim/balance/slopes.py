"""Limited slopes: what a cell shows to its two walls in a scheme of second order."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel
from ..local import Local, at

Array = NDArray[np.float64]


@kernel
def limited(before: float, after: float, steepest: float) -> float:
    """The mean of two differences of one sign, at most `steepest` times the smaller one; 0 if their signs differ.

    The family of van Leer (1979, Towards the ultimate conservative difference scheme V, DOI
    10.1016/0021-9991(79)90145-1): `steepest` 2 is his limiter, "monotonized central" (mc), 1 is minmod.
    """
    if before * after <= 0.0:
        return 0.0
    least = min(abs(before), abs(after))
    size = least if steepest == 1.0 else min(0.5 * abs(before + after), steepest * least)
    return size if after > 0.0 else -size


@kernel
def say(other: float, h: float) -> float:
    """How much the velocity of a neighbour counts: less, where it has less than half of the height.

    So that a film before a front does what dry ground does.
    """
    return min(1.0, 2.0 * other / h) if h > 0.0 else 0.0


@kernel
def reconstruct(
    h: Array, u: Array, theta: Array, steepest: float, beta: Local, fastest: float,
    h_minus: Array, u_minus: Array, h_plus: Array, u_plus: Array,
) -> None:  # fmt: skip
    """Write what each inner cell shows to its left wall (minus) and to its right wall (plus); all arrays are ghosted.

    The slopes s_h, s_u are limited, and 0 where a face of the cell is held wholly (theta = 1). The velocities
    u -+ (h_+-/h) s_u/2 give the two halves of the cell, of h_- and h_+, the momentum of the cell together. A cell whose
    halves move faster than `fastest` is shown as it is.
    """
    for i in range(1, h.size - 1):
        free = 1.0 - max(theta[i - 1], theta[i])
        rise = 0.5 * (free * limited(h[i] - h[i - 1], h[i + 1] - h[i], steepest))
        before, after = say(h[i - 1], h[i]) * (u[i] - u[i - 1]), say(h[i + 1], h[i]) * (u[i + 1] - u[i])
        pull = 0.5 * (free * limited(before, after, steepest))
        low, high = max(h[i] - rise, 0.0), max(h[i] + rise, 0.0)
        v, w = u[i], u[i]
        if h[i] > 0.0:
            v, w = u[i] - high / h[i] * pull, u[i] + low / h[i] * pull
        if max(abs(v) + math.sqrt(2.0 * at(beta, i - 1) * low), abs(w) + math.sqrt(2.0 * at(beta, i) * high)) > fastest:
            low = high = h[i]
            v = w = u[i]
        h_minus[i], u_minus[i], h_plus[i], u_plus[i] = low, v, high, w
