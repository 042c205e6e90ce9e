"""The kinetic wing without a stored density: the rooms of `wing.Density` open when someone asks for f."""

from __future__ import annotations

import numpy as np

from ..balance.stages import Array, Stages
from .carry import carry
from .equilibrium import EQUILIBRIA, Status
from .occupied import LANES, add_held, foresee, sum_cells
from .shift import shift_linear
from .transport import add_sides, transport
from .velocity import Grid
from .wing import Density


class OnDemand(Density):
    """A density of which a step makes only the half-range sums, from one side of one cell at a time.

    M is that of the state at which the step stands; B, f and what stands between them belong to the last step taken.
    Each is made by the kernels of the rooms when it is asked for, and kept until the next step.
    """

    reports = False
    rooms = 3
    """Where someone asks for M, what stands between, and f."""
    _now: Stages
    """The stages of the last step."""
    _stands = False
    """Whether the last step is the one from the state at which M stands."""
    _top = 0.0
    """The outermost node that M occupies there."""

    def _allocate(self, grid: Grid) -> None:
        self._see_room(grid)
        self.grid = grid
        self.xi = grid.xi
        self._w1, self._w2 = self._equilibrium.weights(grid)
        self._averaged = self._equilibrium is EQUILIBRIA["cell-average"]
        self._P, self._N = np.zeros(grid.half), np.zeros(grid.half)
        self._at = grid.edges if self._averaged else grid.xi
        self._speed = np.abs(grid.xi)
        self._lanes = np.zeros(8 * LANES)
        self._h, self._u = np.zeros((2, self._nx + 2))
        self._covers = np.zeros((self._nx + 2, 2), dtype=np.int64)
        self._spans = np.zeros((self._nx, 2), dtype=np.int64)
        self._kept: dict[str, Array] = {}
        self._made: set[str] = set()

    def _widen(self, grid: Grid) -> None:
        if grid.count > self.grid.count:
            self._allocate(grid)

    def equilibrium(self, now: Stages) -> float:
        """The half-range sums of M(h, xi - u); returns the outermost occupied node."""
        self._sum(now)
        if not self._velocity.fits(self.grid, self.reach + self._room):
            self._allocate(self._velocity.grid(self.reach + self._room))
            self._sum(now)
        self._now, self._stands = now, False
        self._made.discard("M")
        return self._top

    def _sum(self, now: Stages) -> None:
        self._top, self.reach = sum_cells(
            now.h, now.u, float(self._beta), self.grid.dxi, self._averaged, self._w1, self._w2, self._lanes,
            self._sums, now.low, now.high,
        )  # fmt: skip

    def support(self, now: Stages) -> None:
        """The outermost occupied nodes of each cell are known with the sums."""

    def half_moments(self, now: Stages) -> Array:
        return self._sums

    def upwind_flux(self, now: Stages) -> None:
        add_sides(self._sums, now.F1, now.F2)

    def held_flux(self, now: Stages) -> None:
        at = now.balanced
        states = (at.h_left, at.u_left, at.h_right, at.u_right)
        add_held(
            now.h, now.u, *states, now.held, now.still, float(self._beta), self.grid.dxi, self._averaged,
            self._w1, self._w2, self._P, self._N, self._sums, now.F1, now.F2, now.at_left, now.at_right,
        )  # fmt: skip

    def transport(self, now: Stages, lam: float) -> None:
        """Remember what f is made of; a window makes room for the shift."""
        self._room = lam * self._pull + self.grid.dxi
        if not self._velocity.fits(self.grid, self.reach + self._room):
            self._widen(self._velocity.grid(self.reach + self._room))
        self._lam = lam
        self._h[:], self._u[:] = now.h, now.u
        self._made &= {"M"}
        self._stands = True

    def force(self, now: Stages) -> float:
        """Foresee what f would show; returns the mass that left the window, per dx, for which f is made if need be."""
        grid = self.grid
        leaves, empty = foresee(now.low, now.high, now.J, now.h1, grid.dxi, grid.half, self._forced)
        self._positive = empty and self._lam * self._top <= 1.0
        self.lost = 0.0
        if self._forced and leaves:
            self._shift()
        return self.lost

    def least(self) -> float:
        """The least entry of f: where (28) holds it is that of an empty node."""
        return 0.0 if self._positive else super().least()

    @property
    def M(self) -> Array:
        M = self._place("M", self._nx + 2)
        if "M" not in self._made:
            now = self._now
            self.fill(now.h, now.u, now.h, now.u, self._beta, M, self.status)
            self._made.add("M")
        return M

    @property
    def B(self) -> Array:
        B = self._place("B", self._nx + 1 if self._scheme.has_faces else 0)
        if "B" not in self._made and B.size:
            self._fill_held(self._now, self._at_held, self._before(), 1.0, np.empty_like(B), B)
        self._made.add("B")
        return B

    @property
    def transported(self) -> Array:
        f = self._place("transported", self._nx)
        if "transported" not in self._made:
            now = self._now
            transport(self._before(), self.B, now.at_left, now.at_right, self.xi, self._lam, f)
            self._made.add("transported")
        return f

    @property
    def f(self) -> Array:
        f = self._place("f", self._nx)
        if "f" not in self._made:
            now, at, grid = self._now, self._now.balanced, self.grid
            faces = None
            if self._scheme.has_faces:
                faces = (at.h_left, at.u_left, at.h_right, at.u_right, now.at_left, now.at_right)
            rows, padded = self._place("rows", 7), self._place("padded", 1, grid.count + 2)[0]
            carry(
                self._h, self._u, faces, now.J, now.h1, self._at, self._speed, float(self._beta), grid.dxi,
                self._averaged, self._lam, self._covers, rows, padded, f, self._spans,
            )  # fmt: skip
            self._made.add("f")
        return f

    def _shift(self) -> None:
        """f, and what of it leaves the window, by the rooms."""
        f = self._place("f", self._nx)
        self.lost = shift_linear(self.transported, self._now.J, self._now.h1, self.grid.dxi, f)
        self._spans[:] = 0, self.grid.count
        self._made.add("f")

    def _place(self, name: str, rows: int, columns: int = 0) -> Array:
        """Where a density is kept once it was asked for."""
        if name not in self._kept:
            self._kept[name] = np.zeros((rows, columns or self.grid.count))
        return self._kept[name]

    def _before(self) -> Array:
        """M at the beginning of the last step."""
        if self._stands:
            return self.M
        M = np.empty((self._nx + 2, self.grid.count))
        self.fill(self._h, self._u, self._h, self._u, self._beta, M, Status.empty(self._nx + 2))
        return M
