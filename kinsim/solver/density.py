"""The density in a step: M, f after transport and f after the force, made when somebody looks."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..kinetic.equilibrium import Status, fill
from ..kinetic.equilibrium.averages import mass_outside
from ..kinetic.equilibrium.questions import reports
from ..kinetic.force import moves_nodes
from ..kinetic.rows import Carrier, cell_rows, face_rows, is_summed
from ..kinetic.velocity import Grid
from ..method import Kinetic
from ..schemes.questions import comes_back, has_own_density
from ..schemes.tile import TILE, Place
from .asked import strongest
from .march import REACH
from .model import model_of

if TYPE_CHECKING:
    from .stages import Stages


class Density:
    """The density in one step, whose stages are known; rows are cells, columns velocities.

    Attributes:
        grid: The velocity cells; a window that follows is as wide as this step asks for.
        xi: Nodes, shape (n,).
    """

    def __init__(self, stages: Stages, grid: Grid | None = None) -> None:
        self._stages = stages
        solver, method = stages.solver, stages.solver.method
        assert isinstance(method, Kinetic)
        assert method.velocity_cells is not None
        self._scene, self._method, self._model = solver.scene, method, solver.model
        self._velocity = method.velocity_cells
        self.grid = grid or self._own_grid()
        if self.grid != solver.grid:
            self._model = model_of(solver.scene, method, self.grid)
            self._carrier = Carrier(self._model, solver.scene.cells.count, self.grid.side)
        else:
            self._carrier = solver.carrier
        self.xi = self.grid.xi

    def _own_grid(self) -> Grid:
        pushed = self._stages.dt * strongest(self._scene)
        return self._velocity.grid(self.reach + pushed, spare=1)

    @property
    def reach(self) -> float:
        """The fastest particle of all states of the step; past the edge of the window, M is cut."""
        return float(self._stages.solver.seen[REACH])

    def _carried(self, *names: str) -> dict[str, Any]:
        wanted, lost = self._carrier(self._stages.dt, self._stages.rooms, *names)
        return {**wanted._asdict(), "lost": lost}

    @cached_property
    def _made(self) -> dict[str, Any]:
        made = self._carried("T", "f", "M", "B")
        if is_summed(self._model.projection):
            own = self._model.projection
            made |= {"T": own.T, "f": own.f, "offset": own.offset}
        return made

    @cached_property
    def _forced(self) -> dict[str, Any]:
        """f alone, in one sweep."""
        if "_made" in self.__dict__ or is_summed(self._model.projection):
            return self._made
        return self._carried("f")

    @property
    def M(self) -> Array:
        """Equilibrium M(h, xi - u) at level n, shape (nx, n)."""
        return self._made["M"]  # type: ignore[no-any-return]

    @property
    def B(self) -> Array:
        """Density at the right face of each cell, shape (nx, n)."""
        return self._made["B"]  # type: ignore[no-any-return]

    @property
    def transported(self) -> Array:
        """f after transport, shape (nx, n)."""
        return self._made["T"]  # type: ignore[no-any-return]

    @property
    def f(self) -> Array:
        """f after the force, shape (nx, n)."""
        return self._forced["f"]  # type: ignore[no-any-return]

    @property
    def offset(self) -> Array:
        """How far the force moved the nodes of each row of f, shape (nx,); 0 where it moved the values."""
        return self._forced["offset"]  # type: ignore[no-any-return]

    @property
    def moves_nodes(self) -> bool:
        """Whether the force moves nodes, and not values."""
        return moves_nodes(self._model.force)

    @cached_property
    def lost(self) -> float:
        """Mass that the force pushed out of the window, per dx."""
        if self._velocity.follows:
            return 0.0
        return float(self._forced["lost"])

    @cached_property
    def cut(self) -> float:
        """The mass of M outside the window, per dx."""
        if self.reach <= self.grid.bound * (1.0 + 1e-12):
            return 0.0
        beta = np.broadcast_to(np.asarray(self._scene.beta, dtype=float), self._stages["h"].shape).copy()
        return float(mass_outside(self._stages["h"], self._stages["u"], beta, self.grid.bound))

    @cached_property
    def held(self) -> Array:
        """What faces hold back of M, shape (nx, n): for xi > 0 at the right wall of a cell, for xi < 0 at the left."""
        half = self.grid.half
        h_left, h_right, h = self._stages["h_left"], self._stages["h_right"], self._stages["h"]
        of = self.equilibrium
        right = of(h, self._stages["u"]) - of(h_left[1:], self._stages["u"])
        left = of(h, self._stages["u"]) - of(h_right[:-1], self._stages["u"])
        return np.concatenate([np.maximum(left[:, :half], 0.0), np.maximum(right[:, half:], 0.0)], axis=1)

    @cached_property
    def status(self) -> Status:
        """How the equilibrium fared in each cell."""
        status = Status.empty(self._scene.cells.count)
        if reports(self._model.flux.equilibrium):
            self.equilibrium(self._stages["h"], self._stages["u"], status=status)
        return status

    def equilibrium(self, h: Array, u: Array, status: Status | None = None) -> Array:
        """M(h, xi - u) on the same nodes, shape (h.size, n)."""
        return fill(self._method.equilibrium, h, u, h, u, self._scene.beta, self.grid, status)

    def wider(self, reach: float) -> Density:
        """The same on more of the same velocity cells."""
        return Density(self._stages, Grid(2 * math.ceil(reach / self.grid.dxi), self.grid.dxi))

    def pushed_from(self, narrow: Density) -> Density:
        """This one, with f as the force makes it of what the narrower density carries after transport."""
        pad = ((0, 0), ((self.grid.count - narrow.grid.count) // 2,) * 2)
        made = self._carrier.push(self._stages.rooms, np.pad(narrow.transported, pad))
        self.__dict__["_forced"] = {**made._asdict(), "lost": 0.0}
        return self

    @cached_property
    def ends(self) -> tuple[Array, Array]:
        """The densities at the left and at the right end of the domain, each of shape (n,)."""
        rooms, nx = self._stages.rooms, self._scene.cells.count
        last = nx - (rooms.shape[0] - 1) * TILE
        places = Place(2, min(nx, TILE), True, nx <= TILE), Place(2 + nx - last, last, nx <= TILE, True)
        left, right = self._end(places[0], -1, rooms[0]), self._end(places[1], last - 1, rooms[-1])
        return left, right

    def _end(self, place: Place, k: int, room: Array) -> Array:
        """The density at face k of a tile, an end of the domain."""
        model, sides = self._model, np.zeros((4, self.grid.half))
        lam, inner = self._stages.dt / model.ground.dx, k + 1 if place.first and k < 0 else k
        if comes_back(model.scheme, k, room):
            cell_rows(model.flux, model.ground.bed, place, inner, room, sides, 0)
            mine = sides[1] if inner > k else sides[0]
            return np.concatenate([mine[::-1], mine])
        if has_own_density(model.scheme, model.order, k, room):
            face_rows(model.scheme, model.order, model.flux, model.ground.bed, place, k, lam, room, sides, 0)
        else:
            cell_rows(model.flux, model.ground.bed, place, k, room, sides, 0)
            cell_rows(model.flux, model.ground.bed, place, k + 1, room, sides, 2)
            sides[1] = sides[3]
        return np.concatenate([sides[1][::-1], sides[0]])
