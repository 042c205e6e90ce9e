"""Held face states: at a slow face static friction holds back part of the density.

The part that is held is the one that the admissible jump of heights would send across. With s = sin zeta and R of
Definition 1, and for the cells i and i + 1 that meet at a face:

    e = clamp(h_{i+1} - h_i; (s - R) dx/beta, (s + R) dx/beta)                       the jump that friction can balance,
    w = (h_i |u_i| + h_{i+1} |u_{i+1}|)/(h_i + h_{i+1})                              how fast the face moves,
    A = max(R, (4/pi) (|s| - R))                                                     what stops it,
    theta = (1 - w (w + sqrt(2 beta min(h_i, h_{i+1})))/(A dx))_+                    the share of e that is held.

theta > 0 where the material of the face is stopped, by friction or by the heap on which it leans, before its fastest
particle has crossed a cell; no dt is in it, so that no time step makes it chatter.

A and the lower height h see to it that a leaning pile that moves downhill compresses. Where one of two cells moves,
|u| << c = sqrt(2 beta h), a mass h |u|/2 moves through their face, and (c/pi) (1 - theta) |e| spills back, since a cell
sends c^3/(3 pi beta) to either side. For |e| = (|s| - R) dx/beta this is at most (2/pi) h |u| (|s| - R)/A, not more
than what moves. With R for A it is more on steep ground, and a pile unravels from any noise.

The face then shows h_i - theta (-e)_+ to the left and h_{i+1} - theta (e)_+ to the right of it, with the velocities of
the cells. M(h, v) grows with h, so no more leaves a cell than it has.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel
from ..local import Local, Sides, at, left, right

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

SAME = 8e-15
"""Jumps of height that differ by less than this share of the sum of heights are the same but for rounding."""


@kernel
def judge_faces(
    h: Array, u: Array, s: Local, R: Local, beta: Local, tilt: Array | None, dx: float,
    wall_left: bool, wall_right: bool, e: Array, theta: Array, still: Flags,
) -> None:  # fmt: skip
    """Write e and theta of every face, and which faces are still, shape (nx + 1,); h, u are ghosted.

    A still face is one between resting cells whose jump friction balances. A wall is judged as the face next to it.
    """
    last = e.size - 1
    for i in range(e.size):
        a, b = h[i], h[i + 1]
        pull, hold, by = at(s, i), at(R, i), at(beta, i)
        low, high = (pull - hold) * dx / by, (pull + hold) * dx / by
        if tilt is not None:
            low, high = low - tilt[i] * (a + b), high - tilt[i] * (a + b)
        e[i] = min(max(b - a, low), high)
        w = (a * abs(u[i]) + b * abs(u[i + 1])) / (a + b) if a + b > 0.0 else 0.0
        slowing = max(hold, (abs(pull) - hold) * (4.0 / math.pi)) * dx
        share = max(1.0 - w * (w + math.sqrt(2.0 * by * max(min(a, b), 0.0))) / slowing, 0.0)
        theta[i] = share if hold > 0.0 else 0.0
    for i in range(e.size):
        a, b = h[i], h[i + 1]
        rest = (theta[i] == 1.0) & (u[i] == 0.0) & (u[i + 1] == 0.0)
        still[i] = rest & (abs((b - a) - e[i]) <= SAME * (a + b))
    if wall_left and last > 1:
        e[0], theta[0], still[0] = e[1], theta[1], still[1]
    if wall_right and last > 1:
        e[last], theta[last], still[last] = e[last - 1], theta[last - 1], still[last - 1]


@kernel
def hold_back(
    h_plus: Array, u_plus: Array, h_minus: Array, u_minus: Array, e: Array, theta: Array, still: Flags,
    uneven: tuple[Array, Array] | None,
    wall_left: bool, wall_right: bool,
    h_left: Array, u_left: Array, h_right: Array, u_right: Array, held: Flags,
) -> None:  # fmt: skip
    """Write the face states, shape (nx + 1,), and where they differ from what the cells show.

    `plus` is what a ghosted cell shows to its right wall, `minus` what it shows to its left one. A still face shows the
    lower height on both sides. A wall shows on both sides what its cell does, so that nothing passes.
    """
    last = e.size - 1
    for i in range(e.size):
        a, b = h_plus[i], h_minus[i + 1]
        above, below = -e[i], e[i]
        if uneven is not None:
            above, below = above - uneven[0][i] * (a + e[i]), below - uneven[1][i] * (b - e[i])
        h_left[i] = max(a - theta[i] * max(above, 0.0), 0.0)
        h_right[i] = max(b - theta[i] * max(below, 0.0), 0.0)
        if still[i]:
            h_left[i] = h_right[i] = min(a, b)
            if uneven is not None:
                h_left[i], h_right[i] = min(a, (1.0 + uneven[0][i]) * b), min(b, (1.0 + uneven[1][i]) * a)
    if wall_left:
        h_left[0] = h_right[0] = max(h_minus[1] - theta[0] * max(e[0], 0.0), 0.0)
    if wall_right:
        h_left[last] = h_right[last] = max(h_plus[last] - theta[last] * max(-e[last], 0.0), 0.0)
    for i in range(e.size):
        u_left[i], u_right[i] = u_plus[i], u_minus[i + 1]
    for i in range(e.size):
        held[i] = (h_left[i] != h_plus[i]) | (h_right[i] != h_minus[i + 1])


@kernel
def rest_flux(h_left: Array, h_right: Array, still: Flags, beta: Sides, F1: Array, F2: Array) -> None:
    """A still face passes no mass, and the pressure of its height: exactly, whatever nodes the density has."""
    for i in range(F1.size):
        F1[i] = 0.0 if still[i] else F1[i]
        one = at(left(beta), i) * h_left[i] * h_left[i]
        other = at(right(beta), i) * h_right[i] * h_right[i]
        F2[i] = 0.25 * one + 0.25 * other if still[i] else F2[i]
