"""M at the nodes, and M averaged over velocity cells."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...arc import arc
from ...kernel import kernel, kernel_inner, kernel_part
from ...local import Local, Sides, at, left, right
from ..velocity import Grid
from .rows import Array, put
from .status import Status


@dataclass(frozen=True)
class Sampled:
    """M of (12) at the nodes; keeps mass only to n^-1.5."""

    least = 2

    def fill(
        self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides, grid: Grid,
        rows: Array, status: Status,
    ) -> None:  # fmt: skip
        sampled(h_left, u_left, h_right, u_right, beta, grid.dxi, rows)

    def weights(self, grid: Grid) -> tuple[Array, Array]:
        return grid.dxi * grid.side, grid.dxi * grid.side**2


@dataclass(frozen=True)
class CellAverage:
    """The exact average of M, (12), over each velocity cell; keeps mass to rounding, all else to n^-2.

    A sum of xi_j^2 over cell averages carries a spurious h dxi^2/12, which the weight xi_j^2 - dxi^2/12 removes.
    """

    least = 2

    def fill(
        self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides, grid: Grid,
        rows: Array, status: Status,
    ) -> None:  # fmt: skip
        cell_average(h_left, u_left, h_right, u_right, beta, grid.dxi, rows)

    def weights(self, grid: Grid) -> tuple[Array, Array]:
        return grid.dxi * grid.side, grid.dxi * (grid.side**2 - grid.dxi * grid.dxi / 12.0)


@kernel
def sampled(h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides, dxi: float, rows: Array) -> None:
    """M = sqrt(max(2 beta h - (xi - u)^2, 0)) / (pi beta) at the nodes."""
    half = rows.shape[1] // 2
    xi = np.empty(2 * half)
    for k in range(half):
        xi[half + k], xi[half - 1 - k] = (k + 0.5) * dxi, -(k + 0.5) * dxi
    for i in range(rows.shape[0]):
        sample(h_left[i], u_left[i], at(left(beta), i), xi, rows, i, half, xi.size)
        sample(h_right[i], u_right[i], at(right(beta), i), xi, rows, i, 0, half)


@kernel_part
def sample(h: float, u: float, beta: float, xi: Array, rows: Array, i: int, begin: int, end: int) -> None:
    """M(h, xi - u) at the nodes from `begin` to below `end`."""
    square = 2.0 * beta * max(h, 0.0)
    scale = 1.0 / (math.pi * beta)
    for j in range(np.uint64(begin), np.uint64(end)):
        w = xi[j] - u
        rows[i, j] = scale * math.sqrt(max(square - w * w, 0.0))


@kernel_inner
def nodes_between(slowest: float, quickest: float, dxi: float, half: int) -> tuple[int, int]:
    """The first of the nodes xi > 0 between two velocities, and one past the last, with one to spare on each side.

    For u - c may be u, at the edge of a velocity cell.
    """
    return int(min(max(slowest / dxi - 1.0, 0.0), half)), math.ceil(min(max(quickest / dxi + 1.0, 0.0), half))


@kernel_inner
def sample_inside(h: float, u: float, beta: float, dxi: float, side: Array) -> tuple[int, int]:
    """The same at nodes that cover the support; returns the first and one past the last, and leaves out the others."""
    square = 2.0 * beta * max(h, 0.0)
    scale = 1.0 / (math.pi * beta)
    c = math.sqrt(square)
    begin, end = nodes_between(u - c, u + c, dxi, side.size)
    end = end if c > 0.0 else begin
    inside = side[begin:end]
    for k in range(inside.size):
        w = (begin + k + 0.5) * dxi - u
        inside[k] = scale * math.sqrt(max(square - w * w, 0.0))
    return begin, max(begin, end)


@kernel
def cell_average(
    h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides, dxi: float, rows: Array
) -> None:
    """Averages of M over velocity cells."""
    half = rows.shape[1] // 2
    side = np.empty(half)
    for i in range(rows.shape[0]):
        average_side(h_left[i], u_left[i], at(left(beta), i), dxi, side)
        put(side, rows[i], True)
        average_side(h_right[i], -u_right[i], at(right(beta), i), dxi, side)
        put(side, rows[i], False)


@kernel_inner
def average_side(h: float, u: float, beta: float, dxi: float, side: Array) -> None:
    """Averages over the cells xi > 0: h/(pi dxi) [G(t)] between the edges, t = (xi - u)/c clipped to [-1, 1]."""
    begin, end = average_inside(h, u, beta, dxi, side)
    side[:begin] = 0.0
    side[end:] = 0.0


@kernel_inner
def average_inside(h: float, u: float, beta: float, dxi: float, side: Array) -> tuple[int, int]:
    """The same from the first cell that M reaches to the last; returns these, last + 1, and leaves out the others."""
    c = math.sqrt(2.0 * beta * max(h, 0.0))
    begin, end = nodes_between(u - c, u + c, dxi, side.size)
    end = end if c > 0.0 else begin
    inside = side[begin:end]
    for k in range(inside.size):
        inside[k] = antiderivative(((begin + k + 1) * dxi - u) / c)
    scale = h / (math.pi * dxi)
    below = antiderivative((begin * dxi - u) / c)
    for k in range(inside.size):
        above = inside[k]
        inside[k] = max(scale * (above - below), 0.0)
        below = above
    return begin, max(begin, end)


@kernel
def antiderivative(t: float) -> float:
    """G(t) = t sqrt(1 - t^2) + arcsin t, clipped to [-1, 1]: G' = 2 sqrt(1 - t^2), G(1) = pi/2.

    Without branches, so that loops over it vectorise.
    """
    x = min(abs(t), 1.0)
    near, far = arc(x)
    angle = 0.5 * math.pi - 2.0 * near if far else near
    return math.copysign(x * math.sqrt((1.0 - x) * (1.0 + x)) + angle, t)


@kernel
def mass_outside(h: Array, u: Array, beta: Local, bound: float) -> float:
    """The mass of M beyond |xi| = bound, summed over the cells."""
    outside = 0.0
    for i in range(h.size):
        if h[i] > 0.0:
            c = math.sqrt(2.0 * at(beta, i) * h[i])
            inside = antiderivative((bound - u[i]) / c) - antiderivative((-bound - u[i]) / c)
            outside += h[i] * max(1.0 - inside / math.pi, 0.0)
    return outside
