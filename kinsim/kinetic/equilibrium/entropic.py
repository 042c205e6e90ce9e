"""The minimiser of the discrete kinetic entropy."""

from __future__ import annotations

import math
from typing import NamedTuple

from ...arrays import Array
from ...compiled import routine
from .few_nodes import few_nodes
from .status import CONVERGED

LONGEST = 60
"""Newton iterations before a fall-back is taken."""

CLOSE = 1e-8
"""Defect at which Newton hands over to `polish`; at the minimum the entropy changes only by its square."""

NEAR = 1e-6
"""Defect that is good enough to `polish` when the iterations are spent."""


class Entropic(NamedTuple):
    """The density of least discrete kinetic entropy with the given mass and momentum.

    The entropy is the sum of H(f, xi) = xi^2 f/2 + (pi^2 beta^2/6) f^3. The minimiser is
    f_j = sqrt(max(2 (A + B xi_j) - xi_j^2, 0)) / (pi beta), the semicircle with two shifted parameters, found by a
    damped Newton iteration on the convex dual. A step is halved until the slope along it turns no more than half way:
    where a node is about to enter the support the dual value is flat to rounding and could not tell. Where the support
    is thinner than the grid two nodes carry it exactly.
    """

    def both_sides(equilibrium, h, u, beta, dxi, P, N):
        return entropic_sides(h, u, beta, dxi, P, N) if u >= 0.0 else entropic_sides(h, -u, beta, dxi, N, P)

    def reports(equilibrium):
        return True

    def wider(equilibrium, dxi):
        return dxi


@routine()
def dual(kappa: float, b: float, u: float, c: float, dxi: float, half: int) -> tuple[float, ...]:
    """Two first and three second derivatives of the dual value at f_j = c sqrt(p_j)/(pi beta).

    p = kappa + 2 b y - y^2 with y = (xi - u)/c; the value is (2/3) sum eta p^(3/2) - kappa, eta = (2/pi) dxi/c, and its
    derivatives are the defects of mass over h and, twice, of momentum about u over h c.
    """
    eta = 2.0 / math.pi * (dxi / c)
    g0, g1, h00, h01, h11 = -1.0, 0.0, 0.0, 0.0, 0.0
    for k in range(half):
        yp, yn = ((k + 0.5) * dxi - u) / c, (-(k + 0.5) * dxi - u) / c
        pp, pn = max(kappa + (2.0 * b - yp) * yp, 0.0), max(kappa + (2.0 * b - yn) * yn, 0.0)
        rp, rn = eta * math.sqrt(pp), eta * math.sqrt(pn)
        ip = eta / math.sqrt(pp) if pp > 0.0 else 0.0
        in_ = eta / math.sqrt(pn) if pn > 0.0 else 0.0
        g0 += rp + rn
        g1 += 2.0 * (rp * yp + rn * yn)
        h00 += 0.5 * (ip + in_)
        h01 += ip * yp + in_ * yn
        h11 += 2.0 * (ip * yp * yp + in_ * yn * yn)
    return g0, g1, h00, h01, h11


@routine()
def entropic_sides(h: float, u: float, beta: float, dxi: float, P: Array, N: Array) -> tuple[int, float, int]:
    """The two sides of the minimiser, u >= 0, with iterations, residual and fall-back."""
    half = P.size
    P[:] = 0.0
    N[:] = 0.0
    if not h > 0.0:
        return 0, 0.0, CONVERGED
    c = math.sqrt(2.0 * beta * h)
    kappa, b = 1.0, 0.0
    if two_nodes_are_optimal(h, u, beta, dxi, half):
        few_nodes(h, u, beta, dxi, False, P, N)
        return 0, 0.0, CONVERGED
    g0, g1, h00, h01, h11 = dual(kappa, b, u, c, dxi, half)
    tries = 0
    while tries < LONGEST and max(abs(g0), abs(g1)) > CLOSE:
        tries += 1
        det = h00 * h11 - h01 * h01
        if det > 1e-14 * h00 * h11:
            dk, db = (h01 * g1 - h11 * g0) / det, (h01 * g0 - h00 * g1) / det
        else:
            dk, db = -g0, -g1
        slope = g0 * dk + g1 * db
        size = 1.0
        while True:
            tried = dual(kappa + size * dk, b + size * db, u, c, dxi, half)
            if tried[0] * dk + tried[1] * db <= -0.5 * slope or size < 1e-10:
                break
            size *= 0.5
        kappa, b = kappa + size * dk, b + size * db
        g0, g1, h00, h01, h11 = tried
    if max(abs(g0), abs(g1)) > NEAR:
        fell = few_nodes(h, u, beta, dxi, False, P, N)
        return tries, max(abs(g0), 0.5 * abs(g1)), fell
    for k in range(half):
        yp, yn = ((k + 0.5) * dxi - u) / c, (-(k + 0.5) * dxi - u) / c
        P[k] = c / (math.pi * beta) * math.sqrt(max(kappa + (2.0 * b - yp) * yp, 0.0))
        N[k] = c / (math.pi * beta) * math.sqrt(max(kappa + (2.0 * b - yn) * yn, 0.0))
    return tries, polish(h, u, c, dxi, P, N), CONVERGED


@routine()
def polish(h: float, u: float, c: float, dxi: float, P: Array, N: Array) -> float:
    """Multiply by 1 + a + b y so that mass and momentum hold to rounding; returns what is left of their defect."""
    weight = dxi / h
    defect = 1.0
    for sweep in range(3):
        s0, s1, s2 = 0.0, 0.0, 0.0
        for k in range(P.size):
            yp, yn = ((k + 0.5) * dxi - u) / c, (-(k + 0.5) * dxi - u) / c
            fp, fn = weight * P[k], weight * N[k]
            s0 += fp + fn
            s1 += fp * yp + fn * yn
            s2 += fp * yp * yp + fn * yn * yn
        defect = max(abs(1.0 - s0), abs(s1))
        det = s0 * s2 - s1 * s1
        if sweep == 2 or defect <= 4e-16 or not det > 0.0:
            break
        a, b = ((1.0 - s0) * s2 + s1 * s1) / det, (-s1 * s0 - (1.0 - s0) * s1) / det
        for k in range(P.size):
            P[k] *= 1.0 + (a + b * (((k + 0.5) * dxi - u) / c))
            N[k] *= 1.0 + (a + b * ((-(k + 0.5) * dxi - u) / c))
    return defect


@routine()
def two_nodes_are_optimal(h: float, u: float, beta: float, dxi: float, half: int) -> bool:
    """Whether the pair of nodes around u with the right mass and momentum satisfies the conditions of the minimum.

    With f on the nodes j and j + 1 only, 2 (A + B xi) = xi^2 + (pi beta f)^2 there; elsewhere it may not exceed xi^2.
    """
    low = math.floor(min(u / dxi - 0.5, float(half)))
    if low + 1 >= half:
        return False
    x0, x1 = (low + 0.5) * dxi, (low + 1.5) * dxi
    share = (u - x0) / dxi
    f0, f1 = h * (1.0 - share) / dxi, h * share / dxi
    left = x0 * x0 + (math.pi * beta * f0) ** 2
    right = x1 * x1 + (math.pi * beta * f1) ** 2
    step = right - left
    return left - step <= (x0 - dxi) ** 2 and right + step <= (x1 + dxi) ** 2
