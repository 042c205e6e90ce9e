"""The update U^n - lam (F_{i+1/2} - F_{i-1/2}), with the flux that each cell chose at each of its walls."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@kernel
def update(
    h: Array, q: Array, F1: Array, F2: Array, B1: Array, B2: Array, at_left: Flags, at_right: Flags,
    lam: float, h1: Array, qhat: Array,
) -> tuple[float, float, float]:  # fmt: skip
    """Write h^{n+1} and the momentum before the impulse, shape (nx,), and balance the books; h is ghosted.

    F is the upwind flux, B the balanced one, shape (nx + 1,); the flags, shape (nx,), say where a cell takes B at its
    left and right wall. Where the two cells of a face disagree, mass appears or vanishes.

    Returns:
        What enters through the left end, through the right end, and what mixed faces create, per dt.
    """
    nx = q.size
    created = 0.0
    before = 0.0
    entered = 0.0
    for i in range(nx):
        left1, left2 = (B1[i], B2[i]) if at_left[i] else (F1[i], F2[i])
        right1, right2 = (B1[i + 1], B2[i + 1]) if at_right[i] else (F1[i + 1], F2[i + 1])
        h1[i] = h[i + 1] - lam * (right1 - left1)
        qhat[i] = q[i] - lam * (right2 - left2)
        if i == 0:
            entered = left1
        else:
            created += left1 - before
        before = right1
    return entered, -before, created
