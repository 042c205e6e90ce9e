"""The flux (24) by two ways that know no closed form: quadrature of M, and sums over a velocity grid."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..kinetic.equilibrium import fill, weights
from ..kinetic.velocity import Grid
from .regimes import States

NODES = 512
"""Velocity cells of the grid that a flux is held against."""

QUADRATURE = 40
"""Gauss-Legendre nodes in theta, xi = u + c sin theta; the integrand is entire, and so many are exact to rounding."""


def by_quadrature(states: States, beta: float) -> tuple[Array, Array]:
    """(F1, F2) of (24) by Gauss-Legendre quadrature of xi^k M over both half-ranges."""
    h_left, u_left, h_right, u_right = states
    left = [_half(h_left, u_left, beta, k) for k in (1, 2)]
    right = [_half(h_right, -u_right, beta, k) for k in (1, 2)]
    return left[0] - right[0], left[1] + right[1]


def _half(h: Array, u: Array, beta: float, k: int) -> Array:
    """The k-th moment of M over xi > 0."""
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE)
    c = np.sqrt(2.0 * beta * h)
    start = np.arcsin(np.clip(np.divide(-u, c, out=np.where(u > 0, -1.0, 1.0), where=c > 0), -1.0, 1.0))
    middle, half = 0.5 * (0.5 * np.pi + start), 0.5 * (0.5 * np.pi - start)
    theta = middle[:, None] + half[:, None] * nodes
    xi = u[:, None] + c[:, None] * np.sin(theta)
    moment: Array = (xi**k * np.cos(theta) ** 2) @ weights * half * 2.0 * h / np.pi
    return moment


def on_grid(states: States, beta: float) -> tuple[Array, Array]:
    """(F1, F2) of (24) by sums over a velocity grid, cell averages of M.

    Each state has a grid that just reaches over its own velocities: in units of its largest |u| + c and of beta = 1
    all of them are the same.
    """
    h_left, u_left, h_right, u_right = states
    c_left, c_right = (np.sqrt(2.0 * beta * h) for h in (h_left, h_right))
    reach = np.maximum(np.abs(u_left) + c_left, np.abs(u_right) + c_right)
    reach = np.where(reach > 0.0, reach, np.sqrt(beta))
    left, right = ((0.5 * (c / reach) ** 2, u / reach) for c, u in ((c_left, u_left), (c_right, u_right)))
    grid = Grid(NODES, 2.0 / NODES)
    rows = fill("cell-average", *left, *right, 1.0, grid)
    ahead, behind = rows[:, grid.half :], rows[:, : grid.half][:, ::-1]
    first, second = weights("cell-average", grid)
    unit = (reach / np.sqrt(beta)) ** 2  # of heights
    return unit * reach * ((ahead - behind) @ first), unit * reach * reach * ((ahead + behind) @ second)
