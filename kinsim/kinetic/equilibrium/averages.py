"""M at the nodes, and M averaged over velocity cells."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...compiled import at, formula, kernel, routine
from ...macroscopic.closed_form import arc


class Sampled(NamedTuple):
    """M of (12) at the nodes; keeps mass only to n^-1.5."""

    def one_side(equilibrium, h, u, beta, dxi, side, other):
        return sample(h, u, beta, dxi, side)

    def is_sampled(equilibrium):
        return True


class CellAverage(NamedTuple):
    """The exact average of M, (12), over each velocity cell; keeps mass to rounding, all else to n^-2.

    A sum of xi_j^2 over cell averages carries a spurious h dxi^2/12, which the weight xi_j^2 - dxi^2/12 removes.
    """

    def one_side(equilibrium, h, u, beta, dxi, side, other):
        return average(h, u, beta, dxi, side)


@formula()
def nodes_between(slowest: float, quickest: float, dxi: float, half: int) -> tuple[int, int]:
    """The first of the nodes xi > 0 between two velocities, and one past the last, with one to spare on each side.

    For u - c may be u, at the edge of a velocity cell.
    """
    begin = int(min(max(slowest / dxi - 1.0, 0.0), half))
    return begin, max(math.ceil(min(max(quickest / dxi + 1.0, 0.0), half)), begin)


@routine()
def sample(h: float, u: float, beta: float, dxi: float, side: Array) -> tuple[int, int]:
    """M = sqrt(max(2 beta h - (xi - u)^2, 0)) / (pi beta) at the nodes xi > 0."""
    square = 2.0 * beta * max(h, 0.0)
    scale = 1.0 / (math.pi * beta)
    c = math.sqrt(square)
    begin, end = nodes_between(u - c, u + c, dxi, side.size)
    end = end if c > 0.0 else begin
    side[:begin] = 0.0
    inside = side[begin:end]
    for k in range(inside.size):
        w = (begin + k + 0.5) * dxi - u
        inside[k] = scale * math.sqrt(max(square - w * w, 0.0))
    side[end:] = 0.0
    return begin, end


@routine()
def average(h: float, u: float, beta: float, dxi: float, side: Array) -> tuple[int, int]:
    """Averages over the velocity cells xi > 0: h/(pi dxi) [G(t)] between the edges, t = (xi - u)/c in [-1, 1]."""
    c = math.sqrt(2.0 * beta * max(h, 0.0))
    begin, end = nodes_between(u - c, u + c, dxi, side.size)
    end = end if c > 0.0 else begin
    side[:begin] = 0.0
    inside = side[begin:end]
    for k in range(inside.size):
        inside[k] = antiderivative(((begin + k + 1) * dxi - u) / c)
    scale = h / (math.pi * dxi)
    below = antiderivative((begin * dxi - u) / c)
    for k in range(inside.size):
        above = inside[k]
        inside[k] = max(scale * (above - below), 0.0)
        below = above
    side[end:] = 0.0
    return begin, end


@formula()
def antiderivative(t: float) -> float:
    """G(t) = t sqrt(1 - t^2) + arcsin t, clipped to [-1, 1]: G' = 2 sqrt(1 - t^2), G(1) = pi/2.

    Without branches, so that loops over it vectorise.
    """
    x = min(abs(t), 1.0)
    near, far = arc(x)
    angle = 0.5 * math.pi - 2.0 * near if far else near
    return math.copysign(x * math.sqrt((1.0 - x) * (1.0 + x)) + angle, t)


@kernel
def mass_outside(h: Array, u: Array, beta: Array, bound: float) -> float:
    """The mass of M beyond |xi| = bound, summed over the cells, per dx."""
    outside = 0.0
    for i in range(h.size):
        if h[i] > 0.0:
            c = math.sqrt(2.0 * at(beta, i) * h[i])
            inside = antiderivative((bound - u[i]) / c) - antiderivative((-bound - u[i]) / c)
            outside += h[i] * max(1.0 - inside / math.pi, 0.0)
    return outside


__all__ = ["CellAverage", "Sampled", "antiderivative", "average", "mass_outside", "np", "sample"]
