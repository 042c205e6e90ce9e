"""The force step: each row of f moves along xi by J/h^{n+1}."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel

Array = NDArray[np.float64]


@kernel
def shift_linear(f: Array, J: Array, h1: Array, dxi: float, out: Array) -> float:
    """(23): f(xi + J/h^{n+1}) <- f(xi) by a conservative linear remap, exact in mass and momentum.

    A shift by k + theta cells hands 1 - theta of a cell to the k-th cell further on and theta to the one behind it.

    Returns:
        The mass that left the window, summed over the rows (times dxi, not yet times dx).
    """
    n = f.shape[1]
    lost = 0.0
    for i in range(f.shape[0]):
        distance = abs(J[i]) / (h1[i] * dxi) if h1[i] > 0.0 else 0.0
        whole = n if not distance < n else int(distance)
        theta = distance - whole if whole < n else 0.0
        back = J[i] < 0.0
        for j in range(n):
            near, far = j - whole, j - whole - 1
            moved = 0.0
            if near >= 0:
                moved = (1.0 - theta) * f[i, n - 1 - near if back else near]
            if far >= 0:
                moved += theta * f[i, n - 1 - far if back else far]
            out[i, n - 1 - j if back else j] = moved
        for j in range(max(n - whole - 1, 0), n):
            gone = 1.0 if j >= n - whole else theta
            lost += gone * f[i, n - 1 - j if back else j]
    return lost * dxi
