"""How it went: what an equilibrium that has to be solved for reports, row by row."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CONVERGED, TWO_NODES, TWO_MOMENTS, MASS_ONLY = 0, 1, 2, 3

FALLBACKS = {
    CONVERGED: "none",
    TWO_NODES: "a mixture of two pairs of nodes with the same moments",
    TWO_MOMENTS: "two nodes that carry mass and momentum only",
    MASS_ONLY: "one node that carries mass only",
}


@dataclass(frozen=True)
class Status:
    """Per row of a density: iterations, relative residual of the promised moments, and what it fell back to.

    Attributes:
        iterations: Shape (rows,).
        residual: Largest defect of a promised moment over h c^k, shape (rows,).
        fallback: A key of `FALLBACKS`, shape (rows,); 0 where the solution was found.
    """

    iterations: NDArray[np.int64]
    residual: NDArray[np.float64]
    fallback: NDArray[np.int64]

    @classmethod
    def empty(cls, rows: int) -> Status:
        """Nothing to report."""
        return cls(np.zeros(rows, dtype=np.int64), np.zeros(rows), np.zeros(rows, dtype=np.int64))

    def put(self, where: NDArray[np.intp], status: Status) -> None:
        """Take over the reports of the rows `where`, and forget those of all others."""
        for mine, theirs in zip(vars(self).values(), vars(status).values(), strict=True):
            mine[:] = 0
            mine[where] = theirs

    @property
    def converged(self) -> NDArray[np.bool_]:
        """Where no fall-back was needed, shape (rows,)."""
        found: NDArray[np.bool_] = self.fallback == CONVERGED
        return found
