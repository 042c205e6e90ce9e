"""The kinetic wing: fluxes as sums over a density that is really there, transported and shifted."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..balance.interface import Faces
from ..balance.stages import Array, Stages
from ..scene import Scene
from .equilibrium import Equilibrium
from .force import shift_linear
from .transport import half_sums, transport
from .velocity import Grid


class Density:
    """What a step asks of a wing, answered by a density on a velocity grid.

    Attributes:
        grid: The velocity cells.
        M: Equilibrium M(h, xi - u) at level n, ghosted, shape (nx + 2, n).
        B: Density at balanced faces, shape (nx + 1, n), or empty where the scheme has none.
        transported: f after transport, shape (nx, n).
        f: f after the force, shape (nx, n).
    """

    def __init__(self, scene: Scene, grid: Grid, equilibrium: Equilibrium, uses_balanced: bool) -> None:
        nx, n = scene.cells.count, grid.count
        self.grid = grid
        self._beta = scene.beta
        self._forced = scene.forced
        self._equilibrium = equilibrium
        self._xi = grid.xi
        self._w1, self._w2 = equilibrium.weights(grid)
        self.M = np.zeros((nx + 2, n))
        self.B = np.zeros((nx + 1 if uses_balanced else 0, n))
        self.transported = np.zeros((nx, n))
        self.f = np.zeros((nx, n)) if scene.forced else self.transported
        self._sums: tuple[NDArray[np.float64], ...] = tuple(np.zeros(nx + 2) for _ in range(4))

    def equilibrium(self, now: Stages) -> None:
        """M_i = M(h_i, xi - u_i), (12)."""
        self._fill(now.h, now.u, now.h, now.u, self.M)

    def upwind_flux(self, now: Stages) -> None:
        """F: the half-range sums of M, xi > 0 from the left cell and xi < 0 from the right one, (19)."""
        P1, P2, N1, N2 = self._sums
        half_sums(self.M, self._w1, self._w2, P1, P2, N1, N2)
        np.add(P1[:-1], N1[1:], out=now.F1)
        np.add(P2[:-1], N2[1:], out=now.F2)

    def balanced_flux(self, now: Stages) -> None:
        """F~: the sums of the density at balanced faces, (25)."""
        at: Faces = now.balanced
        self._fill(at.h_left, at.u_left, at.h_right, at.u_right, self.B)
        P1, P2, N1, N2 = (sums[:-1] for sums in self._sums)
        half_sums(self.B, self._w1, self._w2, P1, P2, N1, N2)
        np.add(P1, N1, out=now.B1)
        np.add(P2, N2, out=now.B2)

    def transport(self, now: Stages, lam: float) -> None:
        """f = M - lam xi (M_{i+1/2} - M_{i-1/2}), (23) before the shift."""
        transport(self.M, self.B, now.at_left, now.at_right, self._xi, lam, self.transported)

    def force(self, now: Stages) -> float:
        """f(xi + J/h^{n+1}) <- f(xi), (23); returns the mass that left the window, per dx."""
        if not self._forced:
            return 0.0
        return shift_linear(self.transported, now.J, now.h1, self.grid.dxi, self.f)

    def _fill(self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, rows: Array) -> None:
        self._equilibrium.fill(h_left, u_left, h_right, u_right, self._beta, self.grid, rows)
