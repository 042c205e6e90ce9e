"""One step with all that is made on its way, and the density in it."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import Array
from ..kinetic.equilibrium import Status
from ..schemes.tile import FACES, NAMES, TILE, WIDTH
from .density import Density
from .march import IN_LEFT_ALL, IN_RIGHT_ALL, MADE_ALL, MENDED_ALL

if TYPE_CHECKING:
    from .solver import Solver


class Books(NamedTuple):
    """What one step did to the mass (h times length), beyond moving it about."""

    inflow_left: float
    inflow_right: float
    coupling_drift: float
    window_loss: float
    mended: float


class Stages:
    """A step from t to t + dt; `stages["h1"]` is a stage by its name in `kinsim.schemes.tile`.

    Attributes:
        solver: A solver that took this step and no other.
        rooms: All stages, one row for each tile.
        dt, t: Length of the step, and the time before it.
    """

    def __init__(self, solver: Solver, rooms: Array, dt: float, t: float) -> None:
        self.solver, self.rooms, self.dt, self.t = solver, rooms, dt, t
        self._nx = solver.scene.cells.count

    def __getitem__(self, name: str) -> Array:
        """A stage: of cells, shape (nx,), or of faces, shape (nx + 1,)."""
        rows = self.rooms.reshape(self.rooms.shape[0], len(NAMES), WIDTH)[:, NAMES.index(name)]
        inner = rows[:, 4 : TILE + 4].reshape(-1)[: self._nx]
        return np.concatenate([rows[:1, 3], inner]) if name in FACES else inner.copy()

    def ghosted(self, name: str) -> Array:
        """A stage of cells with one ghost at each end, shape (nx + 2,)."""
        rows = self.rooms.reshape(self.rooms.shape[0], len(NAMES), WIDTH)[:, NAMES.index(name)]
        last = self._nx - (self.rooms.shape[0] - 1) * TILE
        return np.concatenate([rows[:1, 3], rows[:, 4 : TILE + 4].reshape(-1)[: self._nx], rows[-1:, 4 + last]])

    @cached_property
    def density(self) -> Density:
        """The density in this step; of methods on a velocity grid."""
        return Density(self)

    @property
    def status(self) -> Status | None:
        """How the equilibrium fared in each cell."""
        return self.density.status if self.solver.grid else None

    @property
    def books(self) -> Books:
        """What the step did to the mass."""
        seen = self.solver.seen
        lost = 0.0
        if self.solver.grid is not None:
            lost = self.solver.scene.cells.dx * (self.density.lost + self.density.cut)
        return Books(*(float(seen[at]) for at in (IN_LEFT_ALL, IN_RIGHT_ALL, MADE_ALL)), lost, float(seen[MENDED_ALL]))
