"""Friction where a chute bends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel

Array = NDArray[np.float64]


@kernel
def brake(u: Array, dt: float, grip: float, cos: Array, bend: Array, most: Array) -> None:
    """The most friction that a step of dt can bring to bear; see `Smooth.cells`."""
    for i in range(u.size):
        a = dt * grip * max(bend[i], 0.0) * abs(u[i])
        share = (1.0 - 0.81 / (a + 0.8)) / a if a > 0.1 else 1.0
        most[i] = grip * max(cos[i] + bend[i] * u[i] * u[i] * share, 0.0)
