"""Half-range moments on velocity nodes that are fitted to each cell.

Mirrored so that u <= 0, the side of xi = 0 that holds less of M has the scaled length b = max(c - |u|, 0)/c. With
(xi - u)/c = 1 - b s the density becomes a smooth function times the weight s^(1/2) (1 - s) on [0, 1], for which
Gauss-Jacobi nodes s_j and weights W_j converge geometrically:

    S1 = (2/pi) h c   b^2.5 sum_j W_j           sqrt(2 - b s_j),
    S2 = (2/pi) h c^2 b^3.5 sum_j W_j (1 - s_j) sqrt(2 - b s_j).

f is then a discrete measure with nodes xi_j = c b (1 - s_j); the larger side is the total less this one.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from ..balance.interface import Faces
from ..balance.sides import both_sides
from ..balance.stages import Stages
from ..balance.wing import WithoutDensity
from ..kernel import kernel
from ..scene import Scene

Array = NDArray[np.float64]


@cache
def gauss_jacobi(count: int) -> tuple[Array, Array]:
    """Nodes and weights on [0, 1] for the weight s^(1/2) (1 - s), each of shape (count,)."""
    from scipy.special import roots_jacobi

    t, weights = roots_jacobi(count, 1.0, 0.5)
    return (1.0 + t) / 2.0, weights / 2.0**2.5


@kernel
def half_moments_fitted(h: float, u: float, beta: float, s: Array, W: Array) -> tuple[float, float, float, float]:
    """Moments of xi M and xi^2 M over xi >= 0, then over xi < 0."""
    if not h > 0.0:
        return 0.0, 0.0, 0.0, 0.0
    c = math.sqrt(2.0 * beta * h)
    b = max(c - abs(u), 0.0) / c
    m1, m2 = 0.0, 0.0
    for j in range(s.size):
        root = W[j] * math.sqrt(2.0 - b * s[j])
        m1 += root
        m2 += root * (1.0 - s[j])
    scale = 2.0 / math.pi * h * c * b * b * math.sqrt(b)
    return both_sides(h, u, beta, scale * m1, scale * c * b * m2)


@kernel
def flux_fitted(
    h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: float, s: Array, W: Array, F1: Array, F2: Array
) -> None:
    """F of (24) for every face, shape (nx + 1,)."""
    for i in range(F1.size):
        p1, p2, _, _ = half_moments_fitted(h_left[i], u_left[i], beta, s, W)
        _, _, n1, n2 = half_moments_fitted(h_right[i], u_right[i], beta, s, W)
        F1[i] = p1 + n1
        F2[i] = p2 + n2


@kernel
def half_moments_of_cells(h: Array, u: Array, beta: float, s: Array, W: Array, out: Array) -> None:
    """The same moments of every cell, into `out` of shape (4, h.size)."""
    for i in range(h.size):
        out[0, i], out[1, i], out[2, i], out[3, i] = half_moments_fitted(h[i], u[i], beta, s, W)


class FittedMeasure(WithoutDensity):
    """The kinetic wing on fitted nodes: a few point masses per cell instead of a row of a grid.

    Nodes of neighbours differ, so that transport is known by its moments; the force translates all nodes of a cell.
    """

    def __init__(self, scene: Scene, count: int) -> None:
        super().__init__(scene)
        self._s, self._W = gauss_jacobi(count)

    def half_moments(self, now: Stages) -> Array:
        """Moments over xi > 0 and xi < 0 of each ghosted cell, shape (4, nx + 2)."""
        out = np.empty((4, now.h.size))
        half_moments_of_cells(now.h, now.u, self._beta, self._s, self._W, out)
        return out

    def measure(self, h: Array, u: Array) -> tuple[Array, Array]:
        """Nodes and masses of the smaller side of each cell, each of shape (nx, count), for h, u of shape (nx,)."""
        c = np.sqrt(2.0 * self._beta * np.maximum(h, 0.0))
        b = np.divide(np.maximum(c - np.abs(u), 0.0), c, out=np.zeros_like(c), where=c > 0)[:, None]
        nodes = c[:, None] * b * (1.0 - self._s)
        masses = 2.0 / np.pi * h[:, None] * b**1.5 * self._W * np.sqrt(2.0 - b * self._s) / (1.0 - self._s)
        return -np.sign(np.where(u == 0, -1.0, u))[:, None] * nodes, masses

    def _flux(self, at: Faces, F1: Array, F2: Array) -> None:
        flux_fitted(at.h_left, at.u_left, at.h_right, at.u_right, self._beta, self._s, self._W, F1, F2)
