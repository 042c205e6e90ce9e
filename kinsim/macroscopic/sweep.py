"""Scheme 1 in closed form in two sweeps over tiles of cells that stay in the first-level cache.

What is called for each tile are the kernels of the rooms, so that the bits are theirs; see `stepper.Swept`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..balance.impulse import sliding
from ..balance.sides import faces_of_cells
from ..balance.stages import largest, quicken, split
from ..balance.update import move
from ..kernel import kernel
from .half_moments import small_sides

Array = NDArray[np.float64]

TILE = 512
"""Cells of a tile."""


@kernel
def stand(
    h0: Array, q0: Array, beta: float, left: int, right: int, mirror_left: bool, mirror_right: bool,
    h: Array, u: Array, q: Array, m: Array, room: Array, F1: Array, F2: Array,
) -> float:  # fmt: skip
    """Stand at (h0, q0): h, u with their ghosts, q, and F of (24); returns the largest |u| + c.

    The ghosts show the inner cells `left` and `right`, mirrored where told. `m`, (2, TILE + 1), and `room` are to work
    in.
    """
    nx = h0.size
    for ghost, shown, mirrored in ((0, left, mirror_left), (nx + 1, right, mirror_right)):
        h[ghost] = h0[shown]
        u[ghost] = q0[shown] / h0[shown] if h0[shown] > 0.0 else 0.0
        u[ghost] = -u[ghost] if mirrored else u[ghost]
    room[:] = 0.0
    small_sides(h[:1], u[:1], beta, m[0], m[1])
    for begin in range(0, nx + 1, TILE):
        end = min(begin + TILE, nx + 1)
        last = min(end, nx)
        split(h0[begin:last], q0[begin:last], h[begin : last + 2], u[begin : last + 2])
        q[begin:last] = q0[begin:last]
        quicken(h[begin + 1 : last + 1], u[begin + 1 : last + 1], beta, room)
        small_sides(h[begin + 1 : end + 1], u[begin + 1 : end + 1], beta, m[0, 1:], m[1, 1:])
        faces_of_cells(h[begin : end + 1], u[begin : end + 1], beta, m[0], m[1], F1[begin:end], F2[begin:end])
        m[0, 0], m[1, 0] = m[0, end - begin], m[1, end - begin]
    return largest(room)


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
        sliding(h[around], u[around], h1[here], s, R, beta, dx, dt, J[here])
        for i in range(begin, end):
            q1[i] = qhat[i] + J[i]
