"""The first half of a step of scheme 1 in closed form: one sweep over tiles that stay in the first-level cache.

What is called for each tile are the kernels of the rooms, so that the bits are theirs; see `stepper.Swept`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..balance.sides import faces_of_cells
from ..balance.slide import TILE, show_ends
from ..balance.stages import largest, quicken, split
from ..kernel import kernel
from .half_moments import small_sides

Array = NDArray[np.float64]


@kernel
def sweep(
    h0: Array, q0: Array, beta: float, left: int, right: int, mirror_left: bool, mirror_right: bool,
    h: Array, u: Array, q: Array, m: Array, room: Array, F1: Array, F2: Array,
) -> float:  # fmt: skip
    """Stand at (h0, q0): h, u with their ghosts, q, and F of (24); returns the largest |u| + c.

    The ghosts show the inner cells `left` and `right`, mirrored where told. `m`, (2, TILE + 1), and `room` are to work
    in.
    """
    nx = h0.size
    show_ends(h0, q0, left, right, mirror_left, mirror_right, h, u)
    room[:] = 0.0
    small_sides(h[:1], u[:1], beta, m[0], m[1])
    for begin in range(0, nx + 1, TILE):
        end = min(begin + TILE, nx + 1)
        last = min(end, nx)
        split(h0[begin:last], q0[begin:last], h[begin : last + 2], u[begin : last + 2])
        for i in range(begin, last):
            q[i] = q0[i]  # not by slices: for their complaint about shapes numba compiles its strings, seconds long
        quicken(h[begin + 1 : last + 1], u[begin + 1 : last + 1], beta, room)
        small_sides(h[begin + 1 : end + 1], u[begin + 1 : end + 1], beta, m[0, 1:], m[1, 1:])
        faces_of_cells(h[begin : end + 1], u[begin : end + 1], beta, m[0], m[1], F1[begin:end], F2[begin:end])
        m[0, 0], m[1, 0] = m[0, end - begin], m[1, end - begin]
    return largest(room)
