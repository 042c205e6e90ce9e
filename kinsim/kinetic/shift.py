"""The force step (23): f(xi + J/h^{n+1}) <- f(xi), each row of f moves rigidly along xi."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel, kernel_inner

Array = NDArray[np.float64]


class ShiftExact:
    """Shift (23) by moving the nodes: values stay, node j of row i stands at xi_j + J_i/h_i^{n+1}."""

    derivative = False

    def __call__(self, f: Array, M: Array, J: Array, h: Array, dxi: float, out: Array, offset: Array) -> float:
        out[:] = f
        way(J, h, offset)
        return 0.0


class ShiftLinear:
    """Shift (23) by a conservative linear remap; exact in mass and momentum, keeps f >= 0."""

    derivative = False

    def __call__(self, f: Array, M: Array, J: Array, h: Array, dxi: float, out: Array, offset: Array) -> float:
        return shift_linear(f, J, h, dxi, out)


class ShiftPFC:
    """Shift (23) by the positive and flux-conservative remap of third order.

    After Filbet, Sonnendruecker and Bertrand (2001), Conservative numerical schemes for the Vlasov equation, DOI
    10.1006/jcph.2001.6818. Without its limiter the remap is exact in mass and momentum; where the limiter acts, at the
    rim of the support, the momentum of f errs, and the ledger books it.
    """

    derivative = False

    def __call__(self, f: Array, M: Array, J: Array, h: Array, dxi: float, out: Array, offset: Array) -> float:
        return shift_pfc(f, J, h, dxi, out)


@kernel
def way(J: Array, h: Array, offset: Array) -> None:
    """J/h, 0 where it is dry."""
    for i in range(J.size):
        offset[i] = J[i] / h[i] if h[i] > 0.0 else 0.0


@kernel_inner
def split_shift(J: float, h: float, dxi: float, n: int) -> tuple[int, float]:
    """|J|/h in velocity cells as whole cells and a fraction; n cells when everything leaves, none where it is dry."""
    distance = abs(J) / h / dxi if h > 0.0 else 0.0
    if not distance < n:
        return n, 0.0
    whole = int(distance)
    return whole, distance - whole


@kernel
def shift_linear(f: Array, J: Array, h1: Array, dxi: float, out: Array) -> float:
    """Shift each row of f by J/h1: by whole + theta cells, 1 - theta of a cell lands `whole` cells on, theta behind it.

    Returns:
        The mass that left the window, summed over the rows (times dxi, not yet times dx).
    """
    n, one = f.shape[1], np.uint64(1)
    lost = 0.0
    for i in range(f.shape[0]):
        whole, theta = split_shift(J[i], h1[i], dxi, n)
        keep, back, near = 1.0 - theta, J[i] < 0.0, np.uint64(whole)
        both = np.uint64(max(n - 1 - whole, 0))  # entries to which two others come
        for j in range(n):
            out[i, j] = 0.0
        if whole < n:
            out[i, n - 1 - whole if back else whole] = keep * f[i, n - 1 if back else 0]
        if back:
            for k in range(both):
                out[i, k] = keep * f[i, k + near] + theta * f[i, k + near + one]
        else:
            for k in range(both):
                out[i, k + near + one] = keep * f[i, k + one] + theta * f[i, k]
        for j in range(max(n - whole - 1, 0), n):
            gone = 1.0 if j >= n - whole else theta
            lost += gone * f[i, n - 1 - j if back else j]
    return lost * dxi


@kernel
def shift_pfc(f: Array, J: Array, h1: Array, dxi: float, out: Array) -> float:
    """Shift each row of f by J/h1 with a limited parabola in each cell; returns what left the window, per dx."""
    n = f.shape[1]
    row = np.zeros(n + 4)
    lost = 0.0
    for i in range(f.shape[0]):
        whole, theta = split_shift(J[i], h1[i], dxi, n)
        back = J[i] < 0.0
        peak = 0.0
        for j in range(n):
            row[j + 2] = f[i, n - 1 - j if back else j]
            peak = max(peak, row[j + 2])
            out[i, j] = 0.0
        before = 0.0
        for j in range(n + 1):
            flux = fraction_ahead(row[j + 1], row[j + 2], row[j + 3], peak, theta)
            moved = row[j + 2] - flux + before
            before = flux
            if j + whole < n:
                out[i, n - 1 - j - whole if back else j + whole] = moved
            else:
                lost += moved
    return lost * dxi


@kernel_inner
def fraction_ahead(before: float, here: float, after: float, peak: float, theta: float) -> float:
    """What the foremost `theta` of a cell holds by a parabola with the right averages, limited to stay in [0, peak]."""
    rise, fall = after - here, here - before
    if rise > 0.0:
        rise *= min(1.0, 2.0 * here / rise)
    elif rise < 0.0:
        rise *= min(1.0, -2.0 * (peak - here) / rise)
    if fall > 0.0:
        fall *= min(1.0, 2.0 * (peak - here) / fall)
    elif fall < 0.0:
        fall *= min(1.0, -2.0 * here / fall)
    return theta * (here + (1.0 - theta) * ((2.0 - theta) * rise + (1.0 + theta) * fall) / 6.0)
