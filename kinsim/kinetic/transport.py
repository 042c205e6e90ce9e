"""Upwind transport in x, and the half-range sums that make the fluxes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@kernel
def half_sums(rows: Array, w1: Array, w2: Array, P1: Array, P2: Array, N1: Array, N2: Array) -> None:
    """First and second moment of each row over xi > 0 (P) and xi < 0 (N), summed outward from xi = 0."""
    half = w1.size
    for i in range(rows.shape[0]):
        p1, p2, n1, n2 = 0.0, 0.0, 0.0, 0.0
        for k in range(half):
            p, n = rows[i, half + k], rows[i, half - 1 - k]
            p1 += w1[k] * p
            p2 += w2[k] * p
            n1 -= w1[k] * n
            n2 += w2[k] * n
        P1[i], P2[i], N1[i], N2[i] = p1, p2, n1, n2


@kernel
def sum_rows(rows: Array, side: Array, dxi: float, mass: Array, momentum: Array) -> float:
    """Sums of f and xi f over each row, (20), outward from xi = 0 in pairs, so that mirrored sums are mirrored.

    Returns by how much the sum of `mass` grows.
    """
    half, grown = side.size, 0.0
    for i in range(rows.shape[0]):
        m0, m1 = 0.0, 0.0
        for k in range(half):
            p, n = rows[i, half + k], rows[i, half - 1 - k]
            m0 += p + n
            m1 += (p - n) * side[k]
        grown += m0 * dxi - mass[i]
        mass[i], momentum[i] = m0 * dxi, m1 * dxi
    return grown


@kernel
def add_moved(offset: Array, h: Array, q: Array) -> None:
    """q + offset h, in place."""
    for i in range(q.size):
        q[i] += offset[i] * h[i]


@kernel
def add_sides(sums: Array, F1: Array, F2: Array) -> None:
    """The upwind flux (19): xi > 0 from the left cell, xi < 0 from the right one."""
    for i in range(F1.size):
        F1[i] = sums[0, i] + sums[2, i + 1]
        F2[i] = sums[1, i] + sums[3, i + 1]


@kernel
def transport(M: Array, B: Array, at_left: Flags, at_right: Flags, xi: Array, lam: float, f: Array) -> None:
    """f_i = M_i - lam xi (M_{i+1/2} - M_{i-1/2}): (23) before the shift.

    M is ghosted, shape (nx + 2, n). The density at a face is upwind, (19), or the row of B, shape (nx + 1, n), where
    the flags say so. With (19) and lam |xi| <= 1 no entry of f is negative, rounding included.
    """
    n = xi.size
    half = n // 2
    for i in range(f.shape[0]):
        here = M[i + 1]
        left, right = B[i] if at_left[i] else here, B[i + 1] if at_right[i] else M[i + 2]
        for j in range(half):
            a = -lam * xi[j]
            f[i, j] = (here[j] - a * left[j]) + a * right[j]
        left, right = B[i] if at_left[i] else M[i], B[i + 1] if at_right[i] else here
        for j in range(half, n):
            a = lam * xi[j]
            f[i, j] = (here[j] - a * right[j]) + a * left[j]


@kernel
def transport_reflecting(M: Array, static: Flags, xi: Array, lam: float, f: Array) -> None:
    """The same with upwind faces, where static faces, shape (nx + 1,), send the particles of a cell back into it."""
    n = xi.size
    half = n // 2
    for i in range(f.shape[0]):
        for j in range(n):
            outgoing = lam * abs(xi[j])
            back = static[i + 1] if j < half else static[i]
            if back:
                coming = M[i + 1, n - 1 - j]
            else:
                coming = M[i + 2, j] if j < half else M[i, j]
            f[i, j] = (M[i + 1, j] - outgoing * M[i + 1, j]) + outgoing * coming


@kernel
def occupied(M: Array, dxi: float, low: Array, high: Array) -> None:
    """The outermost nodes at which each row of M is not zero, inf and -inf in a row of zeros."""
    n = M.shape[1]
    half = n // 2
    for i in range(M.shape[0]):
        first, last = 0, n - 1
        while first < n and M[i, first] == 0.0:
            first += 1
        while last >= first and M[i, last] == 0.0:
            last -= 1
        low[i] = (first - half + 0.5) * dxi if first < n else np.inf
        high[i] = (last - half + 0.5) * dxi if last >= first else -np.inf


@kernel
def outermost(M: Array, dxi: float) -> float:
    """The outermost node |xi_j| at which M is not zero, 0 if it is zero everywhere."""
    n = M.shape[1]
    half = n // 2
    top = 0
    for i in range(M.shape[0]):
        for k in range(half, top, -1):
            if M[i, half + k - 1] != 0.0 or M[i, half - k] != 0.0:
                top = k
                break
    return (top - 0.5) * dxi if top > 0 else 0.0
