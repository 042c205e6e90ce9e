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

from ..balance.sides import both_sides
from ..kernel import kernel

Array = NDArray[np.float64]


@kernel
def small_side(h: float, speed: float, beta: float) -> tuple[float, float]:
    """First and second moment over xi > 0 of M(h, xi + speed), speed >= 0; both are at least 0."""
    c = math.sqrt(2.0 * beta * h)
    if not speed < c:
        return 0.0, 0.0
    a = speed / c
    r = math.sqrt((1.0 - a) * (1.0 + a))
    angle = math.acos(a)
    p0 = 0.5 * (angle - a * r)
    p1 = r * r * r / 3.0
    p2 = 0.125 * (angle + a * r * (1.0 - 2.0 * a * a))
    weight = 2.0 * h / math.pi
    m1 = weight * (c * p1 - speed * p0)
    m2 = weight * (speed * speed * p0 - 2.0 * speed * c * p1 + c * c * p2)
    return max(m1, 0.0), max(m2, 0.0)


@kernel
def half_moments_closed(h: float, u: float, beta: float) -> tuple[float, float, float, float]:
    """Moments of xi M and xi^2 M over xi >= 0, then over xi < 0."""
    if not h > 0.0:
        return 0.0, 0.0, 0.0, 0.0
    m1, m2 = small_side(h, abs(u), beta)
    return both_sides(h, u, beta, m1, m2)


@kernel
def half_moments_of_cells(h: Array, u: Array, beta: float, out: Array) -> None:
    """The same of every cell, into `out` of shape (4, h.size)."""
    for i in range(h.size):
        out[0, i], out[1, i], out[2, i], out[3, i] = half_moments_closed(h[i], u[i], beta)


@kernel
def flux_closed(
    h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: float, F1: Array, F2: Array
) -> None:
    """F = (I1 + I2, I3 + I4) of (24) for every face, shape (nx + 1,)."""
    for i in range(F1.size):
        p1, p2, _, _ = half_moments_closed(h_left[i], u_left[i], beta)
        _, _, n1, n2 = half_moments_closed(h_right[i], u_right[i], beta)
        F1[i] = p1 + n1
        F2[i] = p2 + n2
