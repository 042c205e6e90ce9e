"""The second half of a step of scheme 1: from the fluxes to U^{n+1} in one sweep over tiles of cells.

What is done to each cell is what the rooms do, so that the bits are theirs; see `stepper.Sliding`. A tile is made in
one array, in which the compiler knows that nothing overlaps, and then put where the stages stand: so all of it is one
loop in vector registers.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel, kernel_part
from .impulse import drive, is_dry
from .stages import split, velocity

Array = NDArray[np.float64]

TILE = 256
"""Cells of a tile."""

ROOM = np.empty(6 * (TILE + 1))
"""What tiles are made in; kernels hold the interpreter's lock, so that one room serves all threads."""

H1, QHAT, J1, Q1 = (TILE * place for place in range(4))
"""Where in it the stages of a tile stand."""


@kernel_part
def show_ends(
    h0: Array, q0: Array, left: int, right: int, mirror_left: bool, mirror_right: bool, h: Array, u: Array
) -> None:
    """The ghosts of h, u show the inner cells `left` and `right`, mirrored where told."""
    for ghost, shown, mirrored in ((0, left, mirror_left), (h.size - 1, right, mirror_right)):
        h[ghost] = h0[shown]
        u[ghost] = velocity(h0[shown], q0[shown])
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
    h1: Array, qhat: Array, J: Array, q1: Array, room: Array,
) -> None:  # fmt: skip
    """U^{n+1} = U^n - lam (F_{i+1/2} - F_{i-1/2}) + (0, J) with the impulse of scheme 1, and the stages between."""
    lam, one, two = dt / dx, np.uint64(1), np.uint64(2)
    for start in range(0, q.size, TILE):
        begin, count = np.uint64(start), min(TILE, q.size - start)
        for k in range(count):
            i = begin + np.uint64(k)
            after = h[i + one] - lam * (F1[i + one] - F1[i])
            carried = q[i] - lam * (F2[i + one] - F2[i])
            dry = is_dry(h[i], h[i + one], h[i + two], after)
            room[H1 + k] = 0.0 if dry else after
            room[QHAT + k] = 0.0 if dry else carried
            room[J1 + k] = dt * drive(u[i + one], h[i], h[i + two], s, R, beta, dx) * room[H1 + k]
            room[Q1 + k] = room[QHAT + k] + room[J1 + k]
        for k in range(count):
            h1[begin + np.uint64(k)], qhat[begin + np.uint64(k)] = room[H1 + k], room[QHAT + k]
        for k in range(count):
            J[begin + np.uint64(k)], q1[begin + np.uint64(k)] = room[J1 + k], room[Q1 + k]
