"""The kinetic wing: fluxes as sums over a density that is really there, transported and shifted."""

from __future__ import annotations

import numpy as np

from ..balance.interface import Faces
from ..balance.schemes import Scheme
from ..balance.stages import Array, Stages, reach
from ..checkpoint import Kept
from ..local import Sides
from ..memory import require
from ..scene import Scene
from .equilibrium import Equilibrium, Status
from .equilibrium.averages import mass_outside
from .force import Force
from .held import HeldFaces, put_capped, put_flux
from .transport import add_moved, add_sides, half_sums, occupied, outermost, sum_rows, transport, transport_reflecting
from .velocity import Grid, Uniform, Window


class Density:
    """What a step asks of a wing, answered by a density on a velocity grid.

    Attributes:
        grid: The velocity cells.
        offset: How far the force moved the nodes of each row of f, shape (nx,); 0 where it moved the values.
        status: How the equilibrium fared in each row of M.
        face_status: The same for B.
        reports: Whether the statuses can say anything: the equilibrium is solved for.
        lost: Mass that the force pushed out of the window in the last step, per dx.
        reach: The fastest particle of all states at level n; past the edge of the window, M is cut.
    """

    reports = True
    rooms = 5
    """Densities that stand side by side."""

    def __init__(
        self, scene: Scene, velocity: Uniform | Window, equilibrium: Equilibrium, force: Force, scheme: Scheme
    ) -> None:
        self._beta = scene.ground.beta
        self._shown = scene.ground.shown(scheme.sloped)
        self._forced = scene.forced
        self._velocity = velocity
        self._equilibrium = equilibrium
        self._force = force
        self._scheme = scheme
        self._nx = nx = scene.cells.count
        self.offset = np.zeros(nx)
        self.status = Status.empty(nx + 2)
        self.face_status = Status.empty(nx + 1)
        self._sums = np.zeros((4, nx + 2))
        self._at_held = HeldFaces(nx + 1, self._shown.faces)
        self.reach = 0.0
        self.lost = 0.0
        self._pull = scene.cells.dx * float(np.max(np.abs(scene.ground.pull) + scene.ground.hold))  # >= dx |g|
        self._room = 0.0
        self._allocate(velocity.grid(0.0))

    def _allocate(self, grid: Grid) -> None:
        nx, n = self._nx, grid.count
        self._see_room(grid)
        self.grid = grid
        self.xi = grid.xi
        self._w1, self._w2 = self._equilibrium.weights(grid)
        self._M = np.zeros((nx + 2, n))
        self._B = np.zeros((nx + 1 if self._scheme.has_faces else 0, n))
        self._minus = np.zeros((nx + 2, n)) if self._scheme.sloped else self._M
        self._spare = np.zeros((nx + 1, n))  # held rows, before transport writes what is carried
        self._transported = self._spare[:-1]
        self._f = np.zeros((nx, n)) if self._forced else self._transported

    def _see_room(self, grid: Grid) -> None:
        entries = f"{self._nx} x {grid.count} entries"
        require(8.0 * self.rooms * (self._nx + 2) * grid.count, f"{self.rooms} densities of {entries}")

    @property
    def M(self) -> Array:
        """Equilibrium M(h, xi - u) at level n, ghosted, shape (nx + 2, n)."""
        return self._M

    @property
    def B(self) -> Array:
        """Density at balanced or held faces, shape (nx + 1, n), or empty where the scheme has none."""
        return self._B

    @property
    def transported(self) -> Array:
        """f after transport, shape (nx, n)."""
        return self._transported

    @property
    def f(self) -> Array:
        """f after the force, shape (nx, n)."""
        return self._f

    def kept(self) -> Kept:
        """The window as it stands; all else is made anew in a step."""
        return {"count": np.array(self.grid.count), "room": np.array(self._room)}

    def restore(self, kept: Kept) -> None:
        """Take that window."""
        self._allocate(Grid(int(kept["count"]), self.grid.dxi))
        self._room = float(kept["room"])

    def _widen(self, grid: Grid) -> None:
        M, B, pad = self.M, self.B, (grid.count - self.grid.count) // 2
        if pad > 0:
            self._allocate(grid)
            self.M[:, pad:-pad], self.B[:, pad:-pad] = M, B

    def equilibrium(self, now: Stages) -> float:
        """M_i = M(h_i, xi - u_i), (12); returns its outermost occupied node."""
        self.reach = reach(now, self._shown, self._scheme.uses_balanced)
        if not self._velocity.fits(self.grid, self.reach + self._room):
            self._allocate(self._velocity.grid(self.reach + self._room))
        self.fill(*now.plus, *now.plus, self._shown.plus, self.M, self.status)
        if self._scheme.sloped:
            self._show_slopes(now)
        return outermost(self.M, self.grid.dxi)

    def _show_slopes(self, now: Stages) -> None:
        """Two halves of a cell show themselves at its walls; the density of the cell is their mean."""
        half = self.grid.half
        self.fill(*now.minus, *now.minus, self._shown.minus, self._minus, self.status)
        self.B[:, half:], self.B[:, :half] = self.M[:-1, half:], self._minus[1:, :half]
        np.add(self.M, self._minus, out=self.M)
        np.multiply(0.5, self.M, out=self.M)

    def support(self, now: Stages) -> None:
        """The outermost occupied nodes of each cell."""
        occupied(self.M, self.grid.dxi, now.low, now.high)

    def half_moments(self, now: Stages) -> Array:
        """The half-range sums of M in each ghosted cell, shape (4, nx + 2), until they are asked for again."""
        half_sums(self.M, self._w1, self._w2, *self._sums)
        return self._sums

    def upwind_flux(self, now: Stages) -> None:
        """F: the half-range sums of M, xi > 0 from the left cell and xi < 0 from the right one, (19)."""
        half_sums(self.M, self._w1, self._w2, *self._sums)
        add_sides(self._sums, now.F1, now.F2)

    def balanced_flux(self, now: Stages) -> None:
        """F~: the sums of the density at balanced faces, (25)."""
        at: Faces = now.balanced
        self.fill(at.h_left, at.u_left, at.h_right, at.u_right, self._shown.faces, self.B, self.face_status)
        P1, P2, N1, N2 = self._sums[:, :-1]
        half_sums(self.B, self._w1, self._w2, P1, P2, N1, N2)
        np.add(P1, N1, out=now.B1)
        np.add(P2, N2, out=now.B2)

    def held_flux(self, now: Stages) -> None:
        """The one flux of scheme 4: sums of the cells' densities, and of a density of their own at held faces."""
        sloped, held = self._scheme.sloped, self._at_held
        np.logical_or(now.held[:-1], sloped, out=now.at_left)
        np.logical_or(now.held[1:], sloped, out=now.at_right)
        if not sloped:
            self.upwind_flux(now)
        self._fill_held(now, held, self.M, 2.0 if sloped else 1.0, self._spare, self.B)
        self.face_status.put(held.where[: held.count], held.status)
        if sloped:
            sums = self._sums[:, :-1]
            half_sums(self.B, self._w1, self._w2, *sums)
            np.add(sums[0], sums[2], out=now.F1)
            np.add(sums[1], sums[3], out=now.F2)
        else:
            half_sums(self._spare[: held.count], self._w1, self._w2, *self._sums[:, : held.count])
            put_flux(self._sums, held.where, held.count, now.F1, now.F2)

    def _fill_held(self, now: Stages, held: HeldFaces, M: Array, share: float, rows: Array, B: Array) -> None:
        """Write the rows of B at held faces; no face sends more than `share` times what stands before it in M."""
        held.pack(now)
        rows = rows[: held.count]
        if held.count:
            self.fill(*held.states, held.beta, rows, held.status)
        put_capped(rows, held.where, M, share, B)

    def transport(self, now: Stages, lam: float) -> None:
        """f = M - lam xi (M_{i+1/2} - M_{i-1/2}), (23) before the shift; a window makes room for the shift."""
        self._room = lam * self._pull + self.grid.dxi
        if not self._velocity.fits(self.grid, self.reach + self._room):
            self._widen(self._velocity.grid(self.reach + self._room))
        if now.static.any():
            transport_reflecting(self.M, now.static, self.xi, lam, self.transported)
        else:
            transport(self.M, self.B, now.at_left, now.at_right, self.xi, lam, self.transported)

    def pulled(self, now: Stages) -> Array:
        """h^{n+1} in (23), h^n in (18)."""
        return now.h[1:-1] if self._force.derivative else now.h1

    def force(self, now: Stages) -> float:
        """Hand J over to f, (18) or (23); returns the mass that left the window, per dx."""
        if self._forced:
            self.lost = self._push(self.transported, self.M[1:-1], now, self.f)
        return self.lost

    def held(self, now: Stages) -> Array:
        """What faces hold back of M, shape (nx, n): for xi > 0 at the right wall of a cell, for xi < 0 at the left."""
        half, of_cells, at = self.grid.half, self.M[1:-1], now.held
        out = np.zeros_like(of_cells)
        np.subtract(of_cells[:, half:], self.B[1:, half:], out=out[:, half:], where=at[1:, None])
        np.subtract(of_cells[:, :half], self.B[:-1, :half], out=out[:, :half], where=at[:-1, None])
        return out

    def least(self) -> float:
        """The least entry of f after the force."""
        return float(self.f.min())

    def average(self, M: Array) -> None:
        """Mean of what a second stage made of f and of M, the density from which the first one started."""
        np.add(M, self.f, out=self.f)
        np.multiply(0.5, self.f, out=self.f)
        if self.f is not self.transported:
            np.add(M, self.transported, out=self.transported)
            np.multiply(0.5, self.transported, out=self.transported)

    def cut(self, now: Stages) -> float:
        """The mass of M outside the window, per dx."""
        return mass_outside(now.h[1:-1], now.u[1:-1], self._beta, self.grid.bound)

    def on_grid(self, grid: Grid, now: Stages) -> Array:
        """M of the cells, shape (nx, grid.count), on another grid."""
        h, u = now.h[1:-1], now.u[1:-1]
        rows = np.empty((h.size, grid.count))
        self._equilibrium.fill(h, u, h, u, self._beta, grid, rows, Status.empty(h.size))
        return rows

    def forced_on(self, grid: Grid, now: Stages) -> Array:
        """f after the force as it would be on a wider grid with the same cells."""
        pad = ((0, 0), ((grid.count - self.grid.count) // 2,) * 2)
        out = np.empty((self._nx, grid.count))
        self._push(np.pad(self.transported, pad), np.pad(self.M[1:-1], pad), now, out)
        return out

    def _push(self, f: Array, M: Array, now: Stages, out: Array) -> float:
        return self._force(f, M, now.J, self.pulled(now), self.grid.dxi, out, self.offset)

    def fill(
        self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides, rows: Array, status: Status
    ) -> None:
        """Write rows of the equilibrium, xi > 0 from the left states and xi < 0 from the right ones."""
        self._equilibrium.fill(h_left, u_left, h_right, u_right, beta, self.grid, rows, status)

    def add_moved(self, h: Array, q: Array) -> None:
        """Add to q the momentum of nodes that the force has moved."""
        add_moved(self.offset, h, q)

    def sums(self, f: Array, mass: Array, momentum: Array) -> float:
        """Sums of f and xi f over the nodes, (20), into arrays of shape (nx,); returns how much mass that adds."""
        return sum_rows(f, self.grid.side, self.grid.dxi, mass, momentum)
