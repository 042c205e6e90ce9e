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
from ..balance.sides import TINY, both_sides, faces_of_cells, faces_of_states
from ..balance.stages import Stages
from ..balance.wing import WithoutDensity
from ..kernel import kernel, kernel_inner
from ..local import Local, Sides, at, left, right
from ..scene import Scene

Array = NDArray[np.float64]


@cache
def gauss_jacobi(count: int) -> tuple[Array, Array]:
    """Nodes and weights on [0, 1] for the weight s^(1/2) (1 - s), each of shape (count,)."""
    from scipy.special import roots_jacobi

    t, weights = roots_jacobi(count, 1.0, 0.5)
    return (1.0 + t) / 2.0, weights / 2.0**2.5


@kernel_inner
def small_sides_fitted(h: Array, u: Array, beta: Local, s: Array, W: Array, b: Array, m1: Array, m2: Array) -> None:
    """S1 and S2 of many states, node by node; all arrays but s and W have one shape, and `b` is room."""
    for i in range(h.size):
        c = math.sqrt(2.0 * at(beta, i) * max(h[i], 0.0))
        b[i] = max(c - abs(u[i]), 0.0) / max(c, TINY)
        m1[i] = 0.0
        m2[i] = 0.0
    for j in range(s.size):
        node, weight, rest = s[j], W[j], 1.0 - s[j]
        for i in range(h.size):
            root = weight * math.sqrt(2.0 - b[i] * node)
            m1[i] += root
            m2[i] += root * rest
    for i in range(h.size):
        c = math.sqrt(2.0 * at(beta, i) * max(h[i], 0.0))
        scale = 2.0 / math.pi * max(h[i], 0.0) * c * b[i] * b[i] * math.sqrt(b[i])
        m1[i] *= scale
        m2[i] *= scale * c * b[i]


@kernel
def half_moments_of_cells(h: Array, u: Array, beta: Local, s: Array, W: Array, m: Array, out: Array) -> None:
    """Moments of xi M and xi^2 M over xi >= 0, then over xi < 0, into `out` of shape (4, h.size)."""
    small_sides_fitted(h, u, beta, s, W, m[2], m[0], m[1])
    for i in range(h.size):
        out[0, i], out[1, i], out[2, i], out[3, i] = both_sides(h[i], u[i], at(beta, i), m[0, i], m[1, i])


@kernel
def flux_of_cells(h: Array, u: Array, beta: Local, s: Array, W: Array, m: Array, F1: Array, F2: Array) -> None:
    """F of (24) at the faces between ghosted cells, shape (nx + 1,); `m`, (4, nx + 2), is room."""
    small_sides_fitted(h, u, beta, s, W, m[2], m[0], m[1])
    faces_of_cells(h, u, beta, m[0], m[1], F1, F2)


@kernel
def flux_fitted(
    h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides, s: Array, W: Array, m: Array,
    F1: Array, F2: Array,
) -> None:  # fmt: skip
    """F of (24) for every face, shape (nx + 1,), from states of its own; `m`, (5, nx + 1) or more, is room."""
    n = F1.size
    small_sides_fitted(h_left, u_left, left(beta), s, W, m[4, :n], m[0, :n], m[1, :n])
    small_sides_fitted(h_right, u_right, right(beta), s, W, m[4, :n], m[2, :n], m[3, :n])
    faces_of_states(h_left, u_left, h_right, u_right, beta, m, F1, F2)


class FittedMeasure(WithoutDensity):
    """The kinetic wing on fitted nodes: a few point masses per cell instead of a row of a grid.

    Nodes of neighbours differ, so that transport is known by its moments; the force translates all nodes of a cell.
    """

    def __init__(self, scene: Scene, sloped: bool, count: int) -> None:
        super().__init__(scene, sloped)
        self._s, self._W = gauss_jacobi(count)
        self._of_cells = scene.ground.beta

    def half_moments(self, now: Stages) -> Array:
        """Moments over xi > 0 and xi < 0 of each ghosted cell, shape (4, nx + 2)."""
        out = self._half
        half_moments_of_cells(now.h, now.u, self._beta.plus, self._s, self._W, self._room, out)
        return out

    def measure(self, h: Array, u: Array) -> tuple[Array, Array]:
        """Nodes and masses of the smaller side of each cell, each of shape (nx, count), for h, u of shape (nx,)."""
        c = np.sqrt(2.0 * self._of_cells * np.maximum(h, 0.0))
        b = np.divide(np.maximum(c - np.abs(u), 0.0), c, out=np.zeros_like(c), where=c > 0)[:, None]
        nodes = c[:, None] * b * (1.0 - self._s)
        masses = 2.0 / np.pi * h[:, None] * b**1.5 * self._W * np.sqrt(2.0 - b * self._s) / (1.0 - self._s)
        return -np.sign(np.where(u == 0, -1.0, u))[:, None] * nodes, masses

    def _flux_of_cells(self, h: Array, u: Array, F1: Array, F2: Array) -> None:
        flux_of_cells(h, u, self._beta.plus, self._s, self._W, self._room, F1, F2)

    def _flux(self, at: Faces, F1: Array, F2: Array) -> None:
        nodes = (self._s, self._W)
        flux_fitted(at.h_left, at.u_left, at.h_right, at.u_right, self._beta.faces, *nodes, self._room, F1, F2)
