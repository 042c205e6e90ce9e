"""The first half of a step of scheme 1 in closed form: one sweep over tiles that stay in the first-level cache.

What is done to each cell is what the rooms do, so that the bits are theirs; a tile is made in one array, as in
`balance.slide`. See `stepper.Swept`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..balance.sides import between
from ..balance.slide import TILE, show_ends
from ..balance.stages import speed, velocity
from ..kernel import kernel, kernel_part
from .half_moments import small_side

Array = NDArray[np.float64]

H, U, Q, M1, M2, SPEED = ((TILE + 1) * place for place in range(6))
"""Where in the room a tile and the cell before it keep h, u, q, their moments, and the largest |u| + c so far."""


@kernel_part
def put(k: int, h: float, u: float, q: float, beta: float, room: Array) -> None:
    """A cell, in the place k."""
    room[H + k], room[U + k], room[Q + k] = h, u, q
    room[SPEED + k] = max(room[SPEED + k], speed(h, u, beta))
    room[M1 + k], room[M2 + k] = small_side(h, abs(u), beta)


@kernel
def sweep(
    h0: Array, q0: Array, beta: float, left: int, right: int, mirror_left: bool, mirror_right: bool,
    h: Array, u: Array, q: Array, F1: Array, F2: Array, room: Array,
) -> float:  # fmt: skip
    """Stand at (h0, q0): h, u with their ghosts, q, and F of (24); returns the largest |u| + c.

    The ghosts show the inner cells `left` and `right`, mirrored where told. `room`, (6 (TILE + 1),), is to work in.
    """
    nx, one = h0.size, np.uint64(1)
    show_ends(h0, q0, left, right, mirror_left, mirror_right, h, u)
    for k in range(TILE + 1):
        room[SPEED + k] = 0.0
    put(0, h[0], u[0], 0.0, beta, room)
    for start in range(0, nx + 1, TILE):
        begin, faces = np.uint64(start), min(TILE, nx + 1 - start)
        cells = min(faces, nx - start)
        for k in range(cells):
            i = begin + np.uint64(k)
            put(k + 1, h0[i], velocity(h0[i], q0[i]), q0[i], beta, room)
        if cells < faces:
            put(faces, h[nx + 1], u[nx + 1], 0.0, beta, room)
        for k in range(cells):
            i = begin + np.uint64(k)
            h[i + one], u[i + one], q[i] = room[H + k + 1], room[U + k + 1], room[Q + k + 1]
        for k in range(faces):
            i = begin + np.uint64(k)
            F1[i], F2[i] = between(
                room[H + k], room[U + k], beta, room[M1 + k], room[M2 + k],
                room[H + k + 1], room[U + k + 1], beta, room[M1 + k + 1], room[M2 + k + 1],
            )  # fmt: skip
        for row in (H, U, M1, M2):
            room[row] = room[row + faces]
    top = 0.0
    for k in range(TILE + 1):
        top = max(top, room[SPEED + k])
    return top
