"""A step of scheme 4 with faces that hold, where it follows from fluxes: one call before the flux and one after it.

What is called are the kernels of the rooms, so that the bits are theirs; see `stepper.Settling`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel
from .clamp import below_nothing, clamped, clip_velocity
from .hold import hold_back, judge_faces, rest_flux
from .slide import show_ends
from .stages import largest, quicken, split, support
from .update import move

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@kernel
def stand_held(
    h0: Array, q0: Array, s: float, R: float, beta: float, dx: float,
    left: int, right: int, wall_left: bool, wall_right: bool,
    h: Array, u: Array, q: Array, e: Array, theta: Array, still: Flags,
    h_left: Array, u_left: Array, h_right: Array, u_right: Array, held: Flags, low: Array, high: Array, room: Array,
) -> float:  # fmt: skip
    """Stand at (h0, q0): h, u with their ghosts, q, held face states and particles; returns the largest |u| + c.

    The ghosts show the inner cells `left` and `right`, mirrored at walls; `room` is to work in.
    """
    show_ends(h0, q0, left, right, wall_left, wall_right, h, u)
    split(h0, q0, h, u)
    for i in range(q.size):
        q[i] = q0[i]
    judge_faces(h, u, s, R, beta, None, dx, wall_left, wall_right, e, theta, still)
    hold_back(h, u, h, u, e, theta, still, None, wall_left, wall_right, h_left, u_left, h_right, u_right, held)
    support(h, u, beta, low, high)
    room[:] = 0.0
    quicken(h, u, beta, room)
    return largest(room)


@kernel
def settle(
    h: Array, q: Array, h_left: Array, h_right: Array, e: Array, theta: Array, still: Flags, low: Array, high: Array,
    F1: Array, F2: Array, s: float, R: float, beta: float, dx: float, wall_left: bool, wall_right: bool, dt: float,
    h1: Array, qhat: Array, J: Array, q1: Array,
) -> float:  # fmt: skip
    """U^{n+1} = U^n - lam (F_{i+1/2} - F_{i-1/2}) + (0, J) with the clamped impulse, and the stages between.

    Returns the mass that heights below 0 are mended with, per dx.
    """
    rest_flux(h_left, h_right, still, beta, F1, F2)
    move(h, q, F1[:-1], F2[:-1], F1[1:], F2[1:], dt / dx, h1, qhat)
    mended = below_nothing(h1)
    clip_velocity(low, high, h1, qhat)
    clamped(h, h1, qhat, h1, e, theta, still, s, R, beta, dx, dt, wall_left, wall_right, J)
    for i in range(q.size):
        q1[i] = qhat[i] + J[i]
    return mended
