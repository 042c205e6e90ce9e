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
def transport(M: Array, B: Array, at_left: Flags, at_right: Flags, xi: Array, lam: float, f: Array) -> None:
    """f_i = M_i - lam xi (M_{i+1/2} - M_{i-1/2}): (23) before the shift.

    M is ghosted, shape (nx + 2, n). The density at a face is upwind, (19), or the row of B, shape (nx + 1, n), where
    the flags say so. With (19) and lam |xi| <= 1 no entry of f is negative, rounding included.
    """
    n = xi.size
    half = n // 2
    for i in range(f.shape[0]):
        for j in range(half):
            right = B[i + 1, j] if at_right[i] else M[i + 2, j]
            left = B[i, j] if at_left[i] else M[i + 1, j]
            a = -lam * xi[j]
            f[i, j] = (M[i + 1, j] - a * left) + a * right
        for j in range(half, n):
            right = B[i + 1, j] if at_right[i] else M[i + 1, j]
            left = B[i, j] if at_left[i] else M[i, j]
            a = lam * xi[j]
            f[i, j] = (M[i + 1, j] - a * right) + a * left


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
