"""Static faces: where friction can hold what stands on both sides, particles come back from the face.

With D = beta (h_{i+1} - h_i)/dx the leftover friction of a face is L = R - |s - D|. A face is static where L >= 0 but
for rounding, and both its cells are slower than what L stops in a step: |u| <= dt L. No mass passes it; each cell has
its own pressure there, and the ground takes the difference.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel
from ..local import Local, at

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

ROUNDING = 1e-13
"""L may fall short of 0 by so much."""


@kernel
def find_static(
    h: Array, u: Array, s: Local, R: Local, beta: Local, tilt: Array | None, dx: float, dt: float,
    wall_left: bool, wall_right: bool,
    leftover: Array, static: Flags,
) -> None:  # fmt: skip
    """Write L_+ and which faces are static, shape (nx + 1,); h, u are ghosted. A wall is as the face next to it."""
    for i in range(static.size):
        hold, slope = at(R, i), at(beta, i) * (h[i + 1] - h[i]) / dx
        if tilt is not None:
            slope += at(beta, i) * tilt[i] * (h[i] + h[i + 1]) / dx
        spare = hold - abs(at(s, i) - slope)
        leftover[i] = max(spare, 0.0)
        fastest = max(abs(u[i]), abs(u[i + 1]))
        static[i] = hold > 0.0 and spare >= -ROUNDING and fastest <= dt * leftover[i]
    last = static.size - 1
    if wall_left and last > 1:
        leftover[0], static[0] = leftover[1], static[1]
    if wall_right and last > 1:
        leftover[last], static[last] = leftover[last - 1], static[last - 1]


@kernel
def reflected(P: Array, N: Array, static: Flags, F1: Array, F2: Array, B2: Array) -> None:
    """Fluxes from the half-range moments P (xi > 0) and N (xi < 0) of ghosted cells, each of shape (2, nx + 2).

    F2 is the momentum flux as the cell left of a face sees it, B2 as the cell right of it does.
    """
    for i in range(static.size):
        if static[i]:
            F1[i] = 0.0
            F2[i] = 2.0 * P[1, i]
            B2[i] = 2.0 * N[1, i + 1]
        else:
            F1[i] = P[0, i] + N[0, i + 1]
            F2[i] = B2[i] = P[1, i] + N[1, i + 1]


@kernel
def stopped(h1: Array, qhat: Array, leftover: Array, static: Flags, s: Local, R: Local, dt: float, J: Array) -> None:
    """J of a pull and a soft threshold: friction takes from |qhat + dt w s h| what it can, and never reverses.

    w is the share of a cell's faces that are not static; a static face counts with half of the friction left there.
    """
    for i in range(J.size):
        w, spare = 1.0, 0.0
        for face in range(i, i + 2):
            if static[face]:
                w -= 0.5
                spare += 0.5 * leftover[face]
        pull = (dt * (w * at(s, i))) * h1[i]
        most = (dt * (w * at(R, i) + spare)) * h1[i]
        q = qhat[i] + pull
        J[i] = -qhat[i] if abs(q) <= most else pull - math.copysign(most, q)
