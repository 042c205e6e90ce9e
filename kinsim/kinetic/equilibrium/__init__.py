"""The equilibrium M(h, xi - u) of (12) on a velocity grid.

A row of a density is filled from two states, `left` for xi > 0 and `right` for xi < 0: a cell gives its own state
twice, a face the states that meet there.
"""

from __future__ import annotations

from typing import Literal, Protocol

from ...local import Sides
from ..velocity import Grid
from .averages import CellAverage, Sampled
from .entropic import Entropic
from .matched import Matched
from .rows import Array
from .status import Status


class Equilibrium(Protocol):
    """A discrete M, never negative."""

    @property
    def least(self) -> int:
        """Velocity cells it needs at least."""

    def fill(
        self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides, grid: Grid,
        rows: Array, status: Status,
    ) -> None:  # fmt: skip
        """Write rows[i, j]: M(h_left, xi_j - u_left) for xi_j > 0 and M(h_right, xi_j - u_right) for xi_j < 0."""

    def weights(self, grid: Grid) -> tuple[Array, Array]:
        """What xi and xi^2 weigh in a sum over the cells with xi > 0, outward, each of shape (count/2,)."""


EquilibriumName = Literal["cell-average", "sampled", "matched", "entropic"]

EQUILIBRIA: dict[EquilibriumName, Equilibrium] = {
    "cell-average": CellAverage(),
    "sampled": Sampled(),
    "matched": Matched(),
    "entropic": Entropic(),
}

__all__ = ["EQUILIBRIA", "Equilibrium", "EquilibriumName", "Status"]
