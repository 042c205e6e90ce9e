"""The second half of a step of scheme 1: from the fluxes to U^{n+1} in one sweep over tiles of cells.

What is called for each tile are the kernels of the rooms, so that the bits are theirs, while their arrays are still in
the first-level cache; see `stepper.Sliding`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel, kernel_part
from .impulse import keep_dry, sliding
from .stages import split
from .update import move

Array = NDArray[np.float64]

TILE = 512
"""Cells of a tile."""


@kernel_part
def show_ends(
    h0: Array, q0: Array, left: int, right: int, mirror_left: bool, mirror_right: bool, h: Array, u: Array
) -> None:
    """The ghosts of h, u show the inner cells `left` and `right`, mirrored where told."""
    for ghost, shown, mirrored in ((0, left, mirror_left), (h.size - 1, right, mirror_right)):
        h[ghost] = h0[shown]
        u[ghost] = q0[shown] / h0[shown] if h0[shown] > 0.0 else 0.0
        u[ghost] = -u[ghost] if mirrored else u[ghost]


@kernel
def stand(
    h0: Array, q0: Array, left: int, right: int, mirror_left: bool, mirror_right: bool, h: Array, u: Array, q: Array
) -> None:
    """Stand at (h0, q0): h, u with their ghosts, and q. The ghosts show the inner cells told, mirrored where told."""
    show_ends(h0, q0, left, right, mirror_left, mirror_right, h, u)
    split(h0, q0, h, u)
    for i in range(q.size):
        q[i] = q0[i]


@kernel
def slide(
    h: Array, u: Array, q: Array, F1: Array, F2: Array, s: float, R: float, beta: float, dx: float, dt: float,
    h1: Array, qhat: Array, J: Array, q1: Array,
) -> None:  # fmt: skip
    """U^{n+1} = U^n - lam (F_{i+1/2} - F_{i-1/2}) + (0, J) with the impulse of scheme 1, and the stages between."""
    lam = dt / dx
    for begin in range(0, q.size, TILE):
        end = min(begin + TILE, q.size)
        around, here, after = slice(begin, end + 2), slice(begin, end), slice(begin + 1, end + 1)
        move(h[around], q[here], F1[here], F2[here], F1[after], F2[after], lam, h1[here], qhat[here])
        keep_dry(h[around], h1[here], qhat[here])
        sliding(h[around], u[around], h1[here], s, R, beta, dx, dt, J[here])
        for i in range(begin, end):
            q1[i] = qhat[i] + J[i]
