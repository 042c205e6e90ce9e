"""Rows of a density as two sides of xi = 0, each counted outward from there.

A side is an array of shape (count/2,): entry k belongs to xi = (k + 1/2) dxi on the positive side and to the mirrored
xi on the negative one. What is computed for |u| serves u < 0 with the sides exchanged, so that mirrored states give
bitwise mirrored rows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...kernel import kernel_inner

Array = NDArray[np.float64]


@kernel_inner
def put(side: Array, row: Array, positive: bool) -> None:
    """Write a side into its half of an ascending row."""
    half = side.size
    if positive:
        for k in range(half):
            row[half + k] = side[k]
    else:
        for k in range(half):
            row[half - 1 - k] = side[k]
