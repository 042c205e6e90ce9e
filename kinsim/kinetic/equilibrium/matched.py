"""Cell averages of M, corrected so that all three moments (3) hold on the grid."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import routine
from .averages import average
from .few_nodes import few_nodes
from .status import CONVERGED

LARGEST = float(np.finfo(float).max)
"""A residual that is larger is written as this."""


class Matched(NamedTuple):
    """Cell averages times a parabola, so that all three moments (3) hold to rounding.

    The parabola is one in (xi - u)/c. This is what keeps a pile at rest on the grid. Where it would make an entry
    negative, few nodes take over.
    """

    def both_sides(equilibrium, h, u, beta, dxi, P, N):
        return matched_sides(h, u, beta, dxi, P, N) if u >= 0.0 else matched_sides(h, -u, beta, dxi, N, P)

    def reports(equilibrium):
        return True

    def wider(equilibrium, dxi):
        return dxi


@routine()
def matched_sides(h: float, u: float, beta: float, dxi: float, P: Array, N: Array) -> tuple[int, float, int]:
    """The two sides of the matched density, u >= 0, with iterations, residual and fall-back."""
    average(h, u, beta, dxi, P)
    average(h, -u, beta, dxi, N)
    if not h > 0.0:
        return 0, 0.0, CONVERGED
    c = math.sqrt(2.0 * beta * h)
    end = min(P.size, math.ceil((u + c) / dxi))
    weight = dxi / h
    for sweep in range(3):
        s0, s1, s2, s3, s4 = 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(end):
            yp, yn = ((k + 0.5) * dxi - u) / c, (-(k + 0.5) * dxi - u) / c
            fp, fn = weight * P[k], weight * N[k]
            s0 += fp + fn
            s1 += fp * yp + fn * yn
            yp2, yn2 = yp * yp, yn * yn
            s2 += fp * yp2 + fn * yn2
            s3 += fp * yp2 * yp + fn * yn2 * yn
            s4 += fp * yp2 * yp2 + fn * yn2 * yn2
        r0, r1, r2 = 1.0 - s0, -s1, 0.25 - s2
        defect = max(abs(r0), abs(r1), abs(r2))
        if defect <= 4e-16 or (sweep == 2 and defect <= 1e-13):
            return sweep, defect, CONVERGED
        if sweep == 2:
            break
        # Solve sum_j f_j y^k (a + b y + d y^2) = r_k by elimination; s0 > 0 leads.
        m11, m12, t1 = s2 - s1 * s1 / s0, s3 - s1 * s2 / s0, r1 - s1 * r0 / s0
        m22, t2 = s4 - s2 * s2 / s0, r2 - s2 * r0 / s0
        det = m11 * m22 - m12 * m12
        if not det > 1e-6 * m11 * s4:
            break
        b = (t1 * m22 - t2 * m12) / det
        d = (t2 * m11 - t1 * m12) / det
        a = (r0 - b * s1 - d * s2) / s0
        lowest = 1.0
        for k in range(end):
            yp, yn = ((k + 0.5) * dxi - u) / c, (-(k + 0.5) * dxi - u) / c
            factor_p, factor_n = 1.0 + (a + b * yp + d * yp * yp), 1.0 + (a + b * yn + d * yn * yn)
            if P[k] > 0.0:
                lowest = min(lowest, factor_p)
            if N[k] > 0.0:
                lowest = min(lowest, factor_n)
            P[k] *= factor_p
            N[k] *= factor_n
        if not lowest >= 0.0:
            break
    fell = few_nodes(h, u, beta, dxi, True, P, N)
    s0, s1, s2 = 0.0, 0.0, 0.0
    for k in range(P.size):
        for y, f in ((((k + 0.5) * dxi - u) / c, weight * P[k]), ((-(k + 0.5) * dxi - u) / c, weight * N[k])):
            if f > 0.0:
                s0 += f
                s1 += f * y
                s2 += f * y * y
    return sweep, min(max(abs(1.0 - s0), abs(s1), abs(0.25 - s2)), LARGEST), fell
