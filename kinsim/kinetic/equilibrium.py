"""The equilibrium M(h, xi - u) of (12) on a velocity grid.

A row of a density is filled from two states, `left` for xi > 0 and `right` for xi < 0: a cell gives its own state
twice, a face the states that meet there. The half xi < 0 is the mirror image of a half xi > 0, bit for bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel
from .velocity import Grid

Array = NDArray[np.float64]


class Equilibrium(Protocol):
    """A discrete M."""

    def fill(
        self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: float, grid: Grid, rows: Array
    ) -> None:
        """Write rows[i, j]: M(h_left, xi_j - u_left) for xi_j > 0 and M(h_right, xi_j - u_right) for xi_j < 0."""

    def weights(self, grid: Grid) -> tuple[Array, Array]:
        """What xi and xi^2 weigh in a sum over the cells with xi > 0, outward, each of shape (count/2,)."""

    def outermost(self, reach: float, grid: Grid) -> float:
        """The outermost node that a support [-reach, reach] occupies."""


@dataclass(frozen=True)
class Sampled:
    """M at the nodes; keeps mass only to n^-1.5."""

    def fill(
        self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: float, grid: Grid, rows: Array
    ) -> None:
        sampled(h_left, u_left, h_right, u_right, beta, grid.dxi, rows)

    def weights(self, grid: Grid) -> tuple[Array, Array]:
        return grid.dxi * grid.side, grid.dxi * grid.side**2

    def outermost(self, reach: float, grid: Grid) -> float:
        return max(math.ceil(reach / grid.dxi - 0.5) - 0.5, 0.0) * grid.dxi


@dataclass(frozen=True)
class CellAverage:
    """The exact average of M over each velocity cell; keeps mass to rounding, all else to n^-2.

    A sum of xi_j^2 over cell averages carries a spurious h dxi^2/12, which the weight xi_j^2 - dxi^2/12 removes.
    """

    def fill(
        self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: float, grid: Grid, rows: Array
    ) -> None:
        cell_average(h_left, u_left, h_right, u_right, beta, grid.dxi, rows)

    def weights(self, grid: Grid) -> tuple[Array, Array]:
        return grid.dxi * grid.side, grid.dxi * (grid.side**2 - grid.dxi**2 / 12.0)

    def outermost(self, reach: float, grid: Grid) -> float:
        return max(math.ceil(reach / grid.dxi) - 0.5, 0.0) * grid.dxi


EQUILIBRIA: dict[str, Equilibrium] = {"cell-average": CellAverage(), "sampled": Sampled()}
EquilibriumName = Literal["cell-average", "sampled"]


@kernel
def sampled(h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: float, dxi: float, rows: Array) -> None:
    """M = sqrt(max(2 beta h - (xi - u)^2, 0)) / (pi beta) at the nodes."""
    half = rows.shape[1] // 2
    scale = 1.0 / (math.pi * beta)
    for i in range(rows.shape[0]):
        for side in range(2):
            h, u = (h_left[i], u_left[i]) if side == 0 else (h_right[i], -u_right[i])
            square = 2.0 * beta * max(h, 0.0)
            for k in range(half):
                w = (k + 0.5) * dxi - u
                M = scale * math.sqrt(max(square - w * w, 0.0))
                rows[i, half + k if side == 0 else half - 1 - k] = M


@kernel
def cell_average(
    h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: float, dxi: float, rows: Array
) -> None:
    """Averages of M over velocity cells, h/(pi dxi) [G(t)] between the edges, t = (xi - u)/c clipped to [-1, 1]."""
    half = rows.shape[1] // 2
    for i in range(rows.shape[0]):
        for side in range(2):
            h, u = (h_left[i], u_left[i]) if side == 0 else (h_right[i], -u_right[i])
            c = math.sqrt(2.0 * beta * max(h, 0.0))
            first = min(max((u - c) / dxi, 0.0), half)
            last = min(max((u + c) / dxi, 0.0), half)
            begin = int(first)
            end = math.ceil(last) if c > 0.0 else begin
            for k in range(begin):
                rows[i, half + k if side == 0 else half - 1 - k] = 0.0
            scale = h / (math.pi * dxi)
            below = antiderivative((begin * dxi - u) / c)
            for k in range(begin, end):
                above = antiderivative(((k + 1) * dxi - u) / c)
                rows[i, half + k if side == 0 else half - 1 - k] = max(scale * (above - below), 0.0)
                below = above
            for k in range(end, half):
                rows[i, half + k if side == 0 else half - 1 - k] = 0.0


@kernel
def antiderivative(t: float) -> float:
    """G(t) = t sqrt(1 - t^2) + arcsin t, clipped to [-1, 1]: G' = 2 sqrt(1 - t^2), G(1) = pi/2."""
    t = min(max(t, -1.0), 1.0)
    return t * math.sqrt((1.0 - t) * (1.0 + t)) + math.asin(t)
