"""The books of a run over its saved times."""

from __future__ import annotations

import math
from operator import add

import numpy as np

from ..balance.stages import Array, Stages
from ..checkpoint import Kept, part, under
from ..kinetic.equilibrium import Status
from ..kinetic.equilibrium.status import FALLBACKS, MASS_ONLY, TWO_MOMENTS
from ..kinetic.shift import shift_linear
from ..kinetic.wing import Density
from ..local import Local
from ..mean import mean_velocity
from ..scene import Scene
from ..stepper import Books, Stepper
from .lift import LIFT_COLUMNS, lift_of
from .survey import Survey

COLUMNS = {
    "mass": "mass in the domain",
    "momentum": "momentum in the domain",
    "h_min": "least height since the row before",
    "u_max": "largest |u| since the row before",
    "courant": "largest Courant number since the row before",
    "inflow_left": "mass that entered through the left end so far",
    "inflow_right": "mass that entered through the right end so far",
    "coupling_drift": "mass made so far at faces whose two cells took different fluxes",
    "window_loss": "mass that f lost so far over the edge of the velocity window",
    "mended": "mass made so far where U was summed anew from f (window loss included) or a height below 0 was cut",
    "held": "mass that static friction held back at the faces in the step before",
}
"""mass(t) - mass(0) = inflow_left + inflow_right + coupling_drift + mended, to rounding."""

DENSITY_COLUMNS = {
    "sampling_mass": "mass of f less mass of the state",
    "sampling_momentum": "momentum of f less momentum of the state",
    "f_min": "least entry of f since the row before",
    "f_distance": "integral of |f - M| over x and xi, M of the new state",
    "f_tail": "mass of f where M of the new state is zero",
    "fallbacks": "cells and faces times steps so far in which the equilibrium fell back to few nodes",
    "two_moments": "those of them that kept mass and momentum only",
    "mass_only": "those of them that kept the mass only",
    "iterations": "most iterations of the equilibrium in a cell or face since the row before",
    "residual": "largest relative defect that the equilibrium left since the row before",
}
"""Further columns of a kinetic run on a velocity grid."""

EVERY_COLUMN = COLUMNS | DENSITY_COLUMNS | LIFT_COLUMNS


class Ledger:
    """Notes every step, and makes a row of it when the state is saved."""

    def __init__(self, scene: Scene, stepper: Stepper) -> None:
        self._scene, self._stepper = scene, stepper
        self.lift = lift_of(scene)
        self._rows: list[dict[str, float]] = []
        self._booked = Books(0.0, 0.0, 0.0, 0.0, 0.0)
        self._fallbacks = np.zeros(len(FALLBACKS), dtype=np.int64)
        self.least_height = math.inf
        self.least_density = 0.0
        self.worst_courant = 0.0
        self._h_min = self._f_min = math.inf
        self._u_max = self._courant = self._residual = 0.0
        self._iterations = 0

    def start(self, h: Array, q: Array) -> None:
        """The row of the initial state."""
        first = Survey.of(h, q, self._scene.beta)
        self._h_min, self._u_max = first.h_min, first.u_max
        self.save(h, q, started=False)

    def note(self, look: Survey, courant: float, booked: Books, density: Density | None) -> None:
        """A step was taken, by cells with this density, after which the books show `booked`."""
        self._h_min, self._u_max = min(self._h_min, look.h_min), max(self._u_max, look.u_max)
        self._courant = max(self._courant, courant)
        self.least_height = min(self.least_height, look.h_min)
        self.worst_courant = max(self.worst_courant, courant)
        self._booked = booked
        if density is not None:
            self._f_min = min(self._f_min, density.least())
            self.least_density = min(self.least_density, self._f_min)
            if density.reports:
                self._note_status(density.status, slice(1, -1))
                self._note_status(density.face_status, slice(None))

    def with_these(self, books: Books) -> Books:
        """What the books show after a step with these."""
        return Books(*map(add, self._booked, books))

    def save(self, h: Array, q: Array, started: bool = True) -> None:
        """Make a row of what was noted since the row before."""
        dx = self._scene.cells.dx
        row = {
            "mass": math.fsum(h) * dx, "momentum": math.fsum(q) * dx,
            "h_min": self._h_min, "u_max": self._u_max, "courant": self._courant,
            **self._booked._asdict(),
            "held": dx * held(self._stepper.now) if started else 0.0,
        }  # fmt: skip
        density = self._stepper.density
        if density is not None:
            row |= dict.fromkeys(DENSITY_COLUMNS, 0.0)
            if started:
                row |= departure(density, h, q, self._scene.beta, dx)
                row |= {"f_min": self._f_min, **self._fallen()}
                row |= {"iterations": self._iterations, "residual": self._residual}
        self._rows.append(row | self.lift.row())
        self._forget()

    def columns(self) -> dict[str, Array]:
        """The ledger, each column of shape (nt,)."""
        return {name: np.array([row[name] for row in self._rows]) for name in self._rows[0]}

    @property
    def first_mass(self) -> float:
        """The mass in the beginning."""
        return self._rows[0]["mass"]

    def kept(self) -> Kept:
        """The rows so far, and what was noted since the last one."""
        names = list(self._rows[0])
        since = (self.least_height, self.least_density, self.worst_courant, self._h_min, self._f_min, self._u_max,
                 self._courant, self._residual, self._iterations)  # fmt: skip
        return {
            "names": np.array(names), "rows": np.array([[row[name] for name in names] for row in self._rows]),
            "booked": np.array(self._booked), "fallbacks": self._fallbacks.copy(),
            "since": np.array(since, dtype=float), **under("lift", self.lift.kept()),
        }  # fmt: skip

    def restore(self, kept: Kept) -> None:
        """Go on from there."""
        names = kept["names"].tolist()
        self._rows = [dict(zip(names, row, strict=True)) for row in kept["rows"].tolist()]
        self._booked, self._fallbacks = Books(*kept["booked"].tolist()), kept["fallbacks"]
        (self.least_height, self.least_density, self.worst_courant, self._h_min, self._f_min, self._u_max,
         self._courant, self._residual, iterations) = kept["since"].tolist()  # fmt: skip
        self._iterations = int(iterations)
        self.lift.restore(part("lift", kept))

    def _note_status(self, status: Status, rows: slice) -> None:
        self._fallbacks += np.bincount(status.fallback[rows], minlength=len(FALLBACKS))
        self._iterations = max(self._iterations, int(status.iterations.max()))
        self._residual = max(self._residual, float(status.residual.max()))

    def _fallen(self) -> dict[str, float]:
        """How often so far an equilibrium fell back, at all and to less than three moments."""
        counts = self._fallbacks
        return {
            "fallbacks": float(counts[1:].sum()),
            "two_moments": float(counts[TWO_MOMENTS]),
            "mass_only": float(counts[MASS_ONLY]),
        }

    def _forget(self) -> None:
        self._h_min = self._f_min = math.inf
        self._u_max = self._courant = self._residual = 0.0
        self._iterations = 0


def held(now: Stages) -> float:
    """Half the heights that faces hold back, for half of the particles look their way; per dx."""
    back = np.minimum(now.theta * np.maximum(-now.e, 0.0), now.h[:-1])
    forth = np.minimum(now.theta * np.maximum(now.e, 0.0), now.h[1:])
    return 0.5 * float(math.fsum(back) + math.fsum(forth))


def departure(density: Density, h: Array, q: Array, beta: Local, dx: float) -> dict[str, float]:
    """How f, after the force, departs from the new state (h, q) and from its equilibrium."""
    u = mean_velocity(q, h)
    M = np.empty_like(density.f)
    density.fill(h, u, h, u, beta, M, Status.empty(h.size))
    f = density.f
    if density.offset.any():
        f = np.empty_like(density.f)
        shift_linear(density.f, density.offset, np.ones_like(h), density.grid.dxi, f)
    cell = density.grid.dxi * dx
    row_mass = density.f.sum(axis=1)
    momentum = math.fsum(density.f @ density.xi + density.offset * row_mass)
    return {
        "sampling_mass": math.fsum(row_mass) * cell - math.fsum(h) * dx,
        "sampling_momentum": momentum * cell - math.fsum(q) * dx,
        "f_distance": float(np.abs(f - M).sum()) * cell,
        "f_tail": float(f[M == 0.0].sum()) * cell,
    }
