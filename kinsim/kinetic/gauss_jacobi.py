"""Half-range moments on velocity nodes that are fitted to each cell.

Mirrored so that u <= 0, the side of xi = 0 that holds less of M has the scaled length b = max(c - |u|, 0)/c. With
(xi - u)/c = 1 - b s the density becomes a smooth function times the weight s^(1/2) (1 - s) on [0, 1], for which
Gauss-Jacobi nodes s_j and weights W_j converge geometrically:

    S1 = (2/pi) h c   b^2.5 sum_j W_j           sqrt(2 - b s_j),
    S2 = (2/pi) h c^2 b^3.5 sum_j W_j (1 - s_j) sqrt(2 - b s_j).

f is then a discrete measure with nodes xi_j = c b (1 - s_j); the larger side is the total less this one. Nodes of
neighbours differ, so that transport is known by its moments; the force translates all nodes of a cell.
"""

from __future__ import annotations

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..compiled import formula
from ..macroscopic.closed_form import TINY, ahead

SIZES = (2, 3, 4, 6, 8, 16, 32, 64)
"""Lengths of the tuples of nodes; what is left over has the weight 0. Each length is compiled by itself."""


class GaussJacobi(NamedTuple):
    """Half-range moments as sums over nodes in each cell; nodes and weights are tuples of numbers."""

    nodes: tuple[float, ...]
    weights: tuple[float, ...]

    def leave(flux, h, u, beta):
        return ahead(h, u, beta, *fitted(flux.nodes, flux.weights, h, abs(u), beta))

    def leave_both(flux, h, u, beta):
        m1, m2 = fitted(flux.nodes, flux.weights, h, abs(u), beta)
        p1, p2 = ahead(h, u, beta, m1, m2)
        n1, n2 = ahead(h, -u, beta, m1, m2)
        return p1, p2, n1, n2


@formula("contract")
def fitted(
    nodes: tuple[float, ...], weights: tuple[float, ...], h: float, speed: float, beta: float
) -> tuple[float, float]:
    """S1 and S2, first and second moment over xi > 0 of M(h, xi + speed), speed >= 0."""
    c = math.sqrt(2.0 * beta * max(h, 0.0))
    b = max(c - speed, 0.0) / max(c, TINY)
    s1, s2 = 0.0, 0.0
    for j in range(len(nodes)):
        root = weights[j] * math.sqrt(2.0 - b * nodes[j])
        s1 += root
        s2 += root * (1.0 - nodes[j])
    scale = 2.0 / math.pi * max(h, 0.0) * c * b * b * math.sqrt(b)
    return scale * s1, scale * c * b * s2


@cache
def gauss_jacobi(count: int) -> GaussJacobi:
    """The flux with `count` nodes in each cell."""
    from scipy.special import roots_jacobi

    t, weights = roots_jacobi(count, 1.0, 0.5)
    filled = next(size for size in SIZES if size >= count) - count
    nodes, given = [*((1.0 + t) / 2.0).tolist(), *[0.0] * filled], [*(weights / 2.0**2.5).tolist(), *[0.0] * filled]
    return GaussJacobi(tuple(nodes), tuple(given))


def measure(count: int, h: Array, u: Array, beta: Array | float) -> tuple[Array, Array]:
    """Nodes and masses of the smaller side of each cell, each of shape (nx, count), for h, u of shape (nx,)."""
    s, W = (np.array(part)[:count] for part in gauss_jacobi(count))
    c = np.sqrt(2.0 * beta * np.maximum(h, 0.0))
    b = np.divide(np.maximum(c - np.abs(u), 0.0), c, out=np.zeros_like(c), where=c > 0)[:, None]
    nodes = c[:, None] * b * (1.0 - s)
    masses = 2.0 / np.pi * h[:, None] * b**1.5 * W * np.sqrt(2.0 - b * s) / (1.0 - s)
    return -np.sign(np.where(u == 0, -1.0, u))[:, None] * nodes, masses
