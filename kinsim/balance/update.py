"""The update U^n - lam (F_{i+1/2} - F_{i-1/2}), with the flux that each cell takes at each of its walls."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel, kernel_inner, kernel_relaxed

Array = NDArray[np.float64]


class Walls(NamedTuple):
    """Mass and momentum flux that each cell takes at its left and at its right wall, each of shape (nx,)."""

    left1: Array
    left2: Array
    right1: Array
    right2: Array

    @classmethod
    def of(cls, F1: Array, F2: Array) -> Walls:
        """One flux per face, shape (nx + 1,); views."""
        return cls(F1[:-1], F2[:-1], F1[1:], F2[1:])


@kernel
def update(
    h: Array, q: Array, left1: Array, left2: Array, right1: Array, right2: Array, lam: float, h1: Array, qhat: Array
) -> tuple[float, float, float]:
    """Write h^{n+1} and the momentum before the impulse, shape (nx,), and balance the books; h is ghosted.

    Where the two cells of a face take different fluxes, mass appears or vanishes.

    Returns:
        What enters through the left end, through the right end, and what mixed faces create, per dt.
    """
    move(h, q, left1, left2, right1, right2, lam, h1, qhat)
    return left1[0], -right1[q.size - 1], made(left1, right1)


@kernel_inner
def move(
    h: Array, q: Array, left1: Array, left2: Array, right1: Array, right2: Array, lam: float, h1: Array, qhat: Array
) -> None:
    """What the fluxes make of U^n."""
    for i in range(q.size):
        h1[i] = h[i + 1] - lam * (right1[i] - left1[i])
    for i in range(q.size):
        qhat[i] = q[i] - lam * (right2[i] - left2[i])


@kernel_relaxed("reassoc", "nsz")
def made(left1: Array, right1: Array) -> float:
    """What inner faces create, summed in any order."""
    total = 0.0
    for i in range(np.uint64(1), np.uint64(left1.size)):
        total += left1[i] - right1[i - np.uint64(1)]
    return total


@kernel
def mean_of_stages(
    h: Array, q: Array, h2: Array, q_between: Array, q2: Array, J2: Array, F1_then: Array, F2_then: Array,
    h1: Array, q1: Array, qhat: Array, J: Array, F1: Array, F2: Array,
) -> None:  # fmt: skip
    """The mean of U^n = (h, q) and U of the second stage, in place of what the first stage left; h is ghosted.

    What is at rest after both stages is at rest.
    """
    for i in range(q.size):
        h1[i] = 0.5 * (h[i + 1] + h2[i])
        q1[i] = 0.0 if q_between[i] == 0.0 and q2[i] == 0.0 else 0.5 * (q[i] + q2[i])
        J[i] = 0.5 * (J[i] + J2[i])
        qhat[i] = q1[i] - J[i]
    for i in range(F1.size):
        F1[i] = 0.5 * (F1[i] + F1_then[i])
        F2[i] = 0.5 * (F2[i] + F2_then[i])
