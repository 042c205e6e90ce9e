"""The impulse J_i that gravity and friction hand over to a cell in one step, and which cells are slow.

The total acceleration g(u) = sin zeta - sgn(u) R of (1) is written `s - sgn(u) R` here; g is not gravity.
Arrays h, u are ghosted, shape (nx + 2,); all others have shape (nx,).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel, kernel_inner, kernel_part

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

DRY = float(np.finfo(float).tiny)
"""The smallest height whose velocity has all its digits: the smallest normal number. It scales with no unit."""

ROUNDING = 64.0 * float(np.finfo(float).eps)
"""By less than this share of the heights around does rounding miss a height."""


@kernel
def acceleration(v: float, s: float, R: float) -> float:
    """g(v) = s - sgn(v) R for v != 0."""
    return s - R if v > 0.0 else s + R


@kernel_inner
def static_acceleration(slope: float, s: float, R: float) -> float:
    """g~ of (21), (22): what holds the slope beta h_x, as far as friction reaches."""
    return min(s + R, max(slope, s - R))


@kernel_part
def drive(u: float, before: float, after: float, s: float, R: float, beta: float, dx: float) -> float:
    """g of scheme 1, with g~ where u = 0; `before` and `after` are the heights of the neighbours."""
    still = static_acceleration(beta * ((after - before) / (2.0 * dx)), s, R)
    return still if u == 0.0 else acceleration(u, s, R)


@kernel
def sliding(h: Array, u: Array, pulled: Array, s: float, R: float, beta: float, dx: float, dt: float, J: Array) -> None:
    """Scheme 1: J = dt g h^{n+1}, with g~ where u = 0; `pulled` is the height that the force acts on."""
    for i in range(J.size):
        J[i] = dt * drive(u[i + 1], h[i], h[i + 2], s, R, beta, dx) * pulled[i]


@kernel_part
def is_dry(before: float, here: float, after: float, h1: float) -> bool:
    """Whether h^{n+1} is below the smallest normal number, or below 0 by the rounding of the heights around."""
    return (h1 < DRY) & (h1 >= -(ROUNDING * ((before + after) + here)))


@kernel
def keep_dry(h: Array, h1: Array, qhat: Array) -> None:
    """Scheme 1 under (28): a height below the smallest normal number, or below 0 by rounding, is dry; h is ghosted.

    All three heights could come through a face, each with its rounding; what is below 0 by more broke (28), and stays.
    """
    for i in range(h1.size):
        dry = is_dry(h[i], h[i + 1], h[i + 2], h1[i])
        qhat[i] = 0.0 if dry else qhat[i]
        h1[i] = 0.0 if dry else h1[i]


@kernel
def find_slow(q: Array, h1: Array, s: float, R: float, dt: float, slow: Flags) -> None:
    """Slow cells: |q| < |dt g(q) h^{n+1}|, where h1 is the candidate of the balanced flux; q = 0 is slow if forced."""
    for i in range(q.size):
        if q[i] == 0.0:
            slow[i] = s != 0.0 or R != 0.0
        else:
            slow[i] = abs(q[i]) < abs(dt * acceleration(q[i], s, R) * h1[i])


@kernel
def stopping(
    h: Array, q: Array, pulled: Array, h1_candidate: Array, slow: Flags,
    s: float, R: float, beta: float, dx: float, dt: float, J: Array,
) -> None:  # fmt: skip
    """Schemes 2 and 3: slow cells blend static and sliding friction, the others slide.

    In a slow cell q^n + mu dt g h^{n+1} = 0 by the choice of mu, so that its impulse is
    (1 - mu) dt g~ (h_{i+1} + 2 h_i + h_{i-1})/4 - q^n. `pulled` is the height that the force acts on: h^{n+1} of (23)
    or h^n of (18).
    """
    for i in range(J.size):
        if slow[i]:
            mu = 0.0
            if q[i] != 0.0:
                mu = -q[i] / (dt * acceleration(q[i], s, R) * h1_candidate[i])
            g = static_acceleration(beta * ((h[i + 2] - h[i]) / (2.0 * dx)), s, R)
            J[i] = (1.0 - mu) * (dt * g * (0.25 * ((h[i + 2] + h[i]) + 2.0 * h[i + 1]))) - q[i]
        elif q[i] == 0.0:
            J[i] = 0.0
        else:
            J[i] = dt * acceleration(q[i], s, R) * pulled[i]
