"""The force step of (18): f <- f - (J/h^n) dM^n/dxi, a difference instead of a shift.

It acts on M^n, so that its impulse carries h^n where (23) carries h^{n+1}. Density can become negative: with upwind
differences as soon as lam |xi| + |J|/(h dxi) > 1, with centred ones at any step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel

Array = NDArray[np.float64]


class DerivativeUpwind:
    """Derivative (18) of M^n by the one-sided difference from where the force pushes."""

    derivative = True

    def __call__(self, f: Array, M: Array, J: Array, h: Array, dxi: float, out: Array, offset: Array) -> float:
        return derivative_upwind(f, M, J, h, dxi, out)


class DerivativeCentred:
    """Derivative (18) of M^n by the centred difference; for study."""

    derivative = True

    def __call__(self, f: Array, M: Array, J: Array, h: Array, dxi: float, out: Array, offset: Array) -> float:
        return derivative_centred(f, M, J, h, dxi, out)


@kernel
def derivative_upwind(f: Array, M: Array, J: Array, h: Array, dxi: float, out: Array) -> float:
    """out = f - nu (M_j - M_{j-1}), nu = J/(h dxi) > 0, mirrored for nu < 0; returns what left the window, per dx."""
    n = f.shape[1]
    lost = 0.0
    for i in range(f.shape[0]):
        nu = J[i] / h[i] / dxi if h[i] > 0.0 else 0.0
        for j in range(n):
            if nu >= 0.0:
                behind = M[i, j - 1] if j > 0 else 0.0
                out[i, j] = f[i, j] - nu * (M[i, j] - behind)
            else:
                behind = M[i, j + 1] if j < n - 1 else 0.0
                out[i, j] = f[i, j] + nu * (M[i, j] - behind)
        lost += abs(nu) * (M[i, n - 1] if nu >= 0.0 else M[i, 0])
    return lost * dxi


@kernel
def derivative_centred(f: Array, M: Array, J: Array, h: Array, dxi: float, out: Array) -> float:
    """out = f - nu (M_{j+1} - M_{j-1})/2; returns what left the window, per dx."""
    n = f.shape[1]
    lost = 0.0
    for i in range(f.shape[0]):
        nu = J[i] / h[i] / dxi if h[i] > 0.0 else 0.0
        for j in range(n):
            below = M[i, j - 1] if j > 0 else 0.0
            above = M[i, j + 1] if j < n - 1 else 0.0
            out[i, j] = f[i, j] - 0.5 * nu * (above - below)
        lost += 0.5 * nu * (M[i, n - 1] - M[i, 0])
    return lost * dxi
