"""Half-range moments of M in closed form: I1..I4 of section 3.2, corrected, and I~1..I~4 alike.

With c = sqrt(2 beta h), a = |u|/c and r = sqrt((1 - a)(1 + a)) the side of xi = 0 that holds less of M, mirrored so
that u <= 0, has

    m1 = (2 h / pi) (u P0 + c P1),                  P0 = (arccos a - a r)/2,
    m2 = (2 h / pi) (u^2 P0 + 2 u c P1 + c^2 P2),   P1 = r^3/3,  P2 = arccos(a)/8 + a r (1 - 2 a^2)/8,

which is zero for a >= 1; the other side is the total (3) less this one. So mirrored states give bitwise mirrored
moments, and both sides add up to the totals.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from ..arrays import Array
from ..compiled import formula, generic, kernel
from ..schemes.questions import leave_both

TINY = 2.2250738585072014e-308
"""Keeps a division by c defined on dry ground, where its weight is zero."""


class ClosedForm(NamedTuple):
    """The flux of the macroscopic scheme."""

    def leave(flux, h, u, beta):
        return ahead(h, u, beta, *small_side(h, abs(u), beta))

    def leave_both(flux, h, u, beta):
        m1, m2 = small_side(h, abs(u), beta)
        p1, p2 = ahead(h, u, beta, m1, m2)
        n1, n2 = ahead(h, -u, beta, m1, m2)
        return p1, p2, n1, n2


@formula("contract")
def arc(x: float) -> tuple[float, bool]:
    """For 0 <= x <= 1: arcsin x and False where x <= 1/2, else half of arccos x and True; in arithmetic alone.

    arcsin x = x + x^3 P(x^2) for x <= 1/2, and above arccos x = 2 arcsin sqrt((1 - x)/2). P interpolates at Chebyshev
    nodes, relative error 5e-18.
    """
    far = x > 0.5
    z = 0.5 * (1.0 - x) if far else x * x
    s = math.sqrt(z) if far else x
    p = 0.028757851367421566
    p = p * z - 0.014851887071247204
    p = p * z + 0.01740087944269402
    p = p * z + 0.005457506718640358
    p = p * z + 0.01032281435018578
    p = p * z + 0.011479177415184906
    p = p * z + 0.013971212973552933
    p = p * z + 0.017352392720869973
    p = p * z + 0.02237217294214989
    p = p * z + 0.030381944138531247
    p = p * z + 0.04464285714635543
    p = p * z + 0.07499999999998433
    p = p * z + 0.16666666666666669
    return s + s * z * p, far


@formula("contract")
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


@formula()
def ahead(h: float, u: float, beta: float, m1: float, m2: float) -> tuple[float, float]:
    """Moments of xi M and xi^2 M over xi > 0; m1, m2 >= 0 are those of the smaller side, mirrored."""
    h = max(h, 0.0)
    total1 = h * u
    total2 = h * u * u + 0.5 * beta * h * h
    first = total1 + m1 if u > 0.0 else m1
    second = total2 - m2 if u > 0.0 else (m2 if u < 0.0 else 0.5 * total2)
    return first, second


@kernel
def half_moments_closed(h: float, u: float, beta: float) -> tuple[float, float, float, float]:
    """Moments of xi M and xi^2 M over xi >= 0, then over xi < 0, in closed form."""
    if not h > 0.0:
        return 0.0, 0.0, 0.0, 0.0
    m1, m2 = small_side(h, abs(u), beta)
    p1, p2 = ahead(h, u, beta, m1, m2)
    n1, n2 = ahead(h, -u, beta, m1, m2)
    return p1, p2, -n1, n2


@generic
def half_moments_of_cells(flux: Any, h: Array, u: Array, beta: Array, out: Array) -> None:
    """The same of many states by any flux, into `out` of shape (4, h.size)."""
    for i in range(h.size):
        p1, p2, n1, n2 = leave_both(flux, h[i], u[i], beta[i])
        out[0, i], out[1, i], out[2, i], out[3, i] = p1, p2, -n1, n2
