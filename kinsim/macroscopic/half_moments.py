"""Half-range moments of M in closed form: I1..I4 of section 3.2, corrected, and I~1..I~4 alike.

With c = sqrt(2 beta h), a = |u|/c and r = sqrt((1 - a)(1 + a)) the side of xi = 0 that holds less of M, mirrored so
that u <= 0, has

    m1 = (2 h / pi) (u P0 + c P1),                  P0 = (arccos a - a r)/2,
    m2 = (2 h / pi) (u^2 P0 + 2 u c P1 + c^2 P2),   P1 = r^3/3,  P2 = arccos(a)/8 + a r (1 - 2 a^2)/8,

which is zero for a >= 1; the other side is the total less this one. So mirrored states give bitwise mirrored moments,
and both sides add up to the totals (3).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..arc import arc
from ..balance.sides import TINY, both_sides, faces_of_cells, faces_of_states
from ..kernel import kernel, kernel_inner, kernel_relaxed
from ..local import Local, Sides, at, left, right

Array = NDArray[np.float64]


@kernel_relaxed("contract")
def small_side(h: float, speed: float, beta: float) -> tuple[float, float]:
    """First and second moment over xi > 0 of M(h, xi + speed), speed >= 0; both are at least 0."""
    c = math.sqrt(2.0 * beta * max(h, 0.0))
    a = min(speed / max(c, TINY), 1.0)
    r = math.sqrt((1.0 - a) * (1.0 + a))
    near, far = arc(a)
    angle = 2.0 * near if far else 0.5 * math.pi - near
    p0 = 0.5 * (angle - a * r)
    p1 = r * r * r * (1.0 / 3.0)
    p2 = 0.125 * (angle + a * r * (1.0 - 2.0 * a * a))
    weight = 2.0 / math.pi * max(h, 0.0)
    m1 = weight * (c * p1 - speed * p0)
    m2 = weight * (speed * (speed * p0 - 2.0 * (c * p1)) + c * c * p2)
    return max(m1, 0.0), max(m2, 0.0)


@kernel_inner
def small_sides(h: Array, u: Array, beta: Local, m1: Array, m2: Array) -> None:
    """The same of many states, all arrays of one shape."""
    for i in range(h.size):
        m1[i], m2[i] = small_side(h[i], abs(u[i]), at(beta, i))


@kernel
def half_moments_closed(h: float, u: float, beta: float) -> tuple[float, float, float, float]:
    """Moments of xi M and xi^2 M over xi >= 0, then over xi < 0."""
    if not h > 0.0:
        return 0.0, 0.0, 0.0, 0.0
    m1, m2 = small_side(h, abs(u), beta)
    return both_sides(h, u, beta, m1, m2)


@kernel
def half_moments_of_cells(h: Array, u: Array, beta: Local, out: Array) -> None:
    """The same of every cell, into `out` of shape (4, h.size)."""
    for i in range(h.size):
        out[0, i], out[1, i], out[2, i], out[3, i] = half_moments_closed(h[i], u[i], at(beta, i))


@kernel
def flux_of_cells(h: Array, u: Array, beta: Local, m: Array, F1: Array, F2: Array) -> None:
    """F = (I1 + I2, I3 + I4) of (24) at the faces between ghosted cells, shape (nx + 1,); `m`, (2, nx + 2), is room."""
    small_sides(h, u, beta, m[0], m[1])
    faces_of_cells(h, u, beta, m[0], m[1], F1, F2)


@kernel
def flux_closed(
    h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides, m: Array, F1: Array, F2: Array
) -> None:
    """F of (24) for every face, shape (nx + 1,), from states of its own; `m`, (4, nx + 1) or more, is room."""
    n = F1.size
    small_sides(h_left, u_left, left(beta), m[0, :n], m[1, :n])
    small_sides(h_right, u_right, right(beta), m[2, :n], m[3, :n])
    faces_of_states(h_left, u_left, h_right, u_right, beta, m, F1, F2)
