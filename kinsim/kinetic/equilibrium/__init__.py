"""The equilibrium M(h, xi - u) of (12) on a velocity grid: four ways in which it stands there."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Array
from ...method import EquilibriumName
from ..velocity import Grid
from .averages import CellAverage, Sampled
from .entropic import Entropic
from .matched import Matched
from .questions import both_sides, fill_rows, is_sampled, one_side, reports, wider
from .status import Status

EQUILIBRIA: dict[EquilibriumName, Any] = {
    "cell-average": CellAverage(),
    "sampled": Sampled(),
    "matched": Matched(),
    "entropic": Entropic(),
}


def weights(name: EquilibriumName, grid: Grid) -> tuple[Array, Array]:
    """What xi and xi^2 weigh in a sum over the cells with xi > 0, outward, each of shape (n/2,)."""
    spurious = grid.dxi * grid.dxi / 12.0 if name == "cell-average" else 0.0
    return grid.dxi * grid.side, grid.dxi * (grid.side**2 - spurious)


def fill(
    name: EquilibriumName, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Any, grid: Grid,
    status: Status | None = None,
) -> Array:  # fmt: skip
    """Rows of M, shape (h.size, n): of the left states for xi > 0, of the right ones for xi < 0.

    `beta` is a number, an array, or a pair of arrays of the left and the right side.
    """
    rows = np.zeros((h_left.size, grid.count))
    left, right = beta if isinstance(beta, tuple) else (beta, beta)
    betas = (np.broadcast_to(np.asarray(side, dtype=float), h_left.shape).copy() for side in (left, right))
    status = status or Status.empty(h_left.size)
    states = (np.ascontiguousarray(part, dtype=float) for part in (h_left, u_left, h_right, u_right))
    reported = (status.iterations, status.residual, status.fallback)
    fill_rows(EQUILIBRIA[name], *states, *betas, grid.dxi, rows, *reported)
    return rows


__all__ = [
    "EQUILIBRIA", "EquilibriumName", "Status", "both_sides", "fill", "is_sampled", "one_side", "reports",
    "weights", "wider",
]  # fmt: skip
