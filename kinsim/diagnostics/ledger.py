"""The ledger of a run: what it gained and lost, and its extremes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..checkpoint import Kept
from ..kinetic.equilibrium.status import MASS_ONLY, TWO_MOMENTS
from ..kinetic.force import moved
from ..mean import mean_velocity
from ..method import Kinetic, Macroscopic
from ..scene import Scene
from ..solver.march import (
    F_MIN,
    H_MIN,
    IN_LEFT_ALL,
    IN_RIGHT_ALL,
    LIFT_MOST,
    LOST_ALL,
    MADE_ALL,
    MENDED_ALL,
    U_MAX,
    WORST,
)  # fmt: skip
from .lift import LIFT_COLUMNS, lift_row, lifts

if TYPE_CHECKING:
    from ..solver.density import Density
    from ..solver.solver import Block, Solver
    from ..solver.stages import Stages

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
    """Makes a row of what was seen since the row before.

    Attributes:
        least_height, least_density, worst_courant: Over all steps.
    """

    def __init__(self, scene: Scene, method: Kinetic | Macroscopic) -> None:
        self._scene = scene
        self._density = method.velocity_cells is not None
        self._lifts = lifts(scene)
        self._rows: list[dict[str, float]] = []
        self.least_height, self.least_density, self.worst_courant = math.inf, 0.0, 0.0

    def start(self, solver: Solver) -> None:
        """The row of the initial state."""
        h, u = solver.h, mean_velocity(solver.q, solver.h)
        solver.seen[H_MIN], solver.seen[U_MAX] = float(h.min()), float(np.abs(u).max())
        row = self._row(solver, 0.0)
        if self._density:
            row |= dict.fromkeys(DENSITY_COLUMNS, 0.0)
        self._rows.append(row | self._lift_row(solver))
        self._forget(solver)

    def note(self, block: Block) -> None:
        """A block of steps was taken."""
        seen = block.solver.seen
        self.least_height = min(self.least_height, float(seen[H_MIN]))
        self.worst_courant = max(self.worst_courant, float(seen[WORST]))
        self.least_density = min(self.least_density, float(seen[F_MIN]))

    def save(self, block: Block) -> None:
        """Make a row of what was seen since the row before."""
        solver, stages = block.solver, block.stages
        row = self._row(solver, self._scene.cells.dx * held(stages))
        if self._density:
            row |= departure(stages.density, block.h, block.q, self._scene.cells.dx)
            least = min(float(solver.seen[F_MIN]), float(stages.density.f.min()))
            self.least_density = min(self.least_density, least)
            row |= {"f_min": least, **fallen(solver.model.flux.report)}
        self._rows.append(row | self._lift_row(solver))
        self._forget(solver)

    def columns(self) -> dict[str, Array]:
        """The ledger, each column of shape (nt,)."""
        return {name: np.array([row[name] for row in self._rows]) for name in self._rows[0]}

    def kept(self) -> Kept:
        """The rows so far, and what was noted since the last one."""
        names = list(self._rows[0])
        rows = np.array([[row[name] for name in names] for row in self._rows])
        since = np.array([self.least_height, self.least_density, self.worst_courant])
        return {"names": np.array(names), "rows": rows, "since": since}

    def restore(self, kept: Kept) -> None:
        """Go on from there."""
        names = kept["names"].tolist()
        self._rows = [dict(zip(names, row, strict=True)) for row in kept["rows"].tolist()]
        self.least_height, self.least_density, self.worst_courant = kept["since"].tolist()

    def _row(self, solver: Solver, held_back: float) -> dict[str, float]:
        seen, dx = solver.seen, self._scene.cells.dx
        return {
            "mass": math.fsum(solver.h) * dx, "momentum": math.fsum(solver.q) * dx,
            "h_min": float(seen[H_MIN]), "u_max": float(seen[U_MAX]), "courant": float(seen[WORST]),
            "inflow_left": float(seen[IN_LEFT_ALL]), "inflow_right": float(seen[IN_RIGHT_ALL]),
            "coupling_drift": float(seen[MADE_ALL]), "window_loss": float(seen[LOST_ALL]),
            "mended": float(seen[MENDED_ALL]), "held": held_back,
        }  # fmt: skip

    def _lift_row(self, solver: Solver) -> dict[str, float]:
        if not self._lifts:
            return {}
        return lift_row(self._scene, solver.seen)

    def _forget(self, solver: Solver) -> None:
        solver.seen[[H_MIN, U_MAX, WORST, LIFT_MOST, F_MIN]] = math.inf, 0.0, 0.0, 0.0, math.inf
        if self._density:
            solver.model.flux.report[4:] = 0.0


def fallen(report: Array) -> dict[str, float]:
    """How often so far an equilibrium fell back, at all and to less than three moments, and how hard it was."""
    return {
        "fallbacks": float(report[1:4].sum()), "two_moments": float(report[TWO_MOMENTS]),
        "mass_only": float(report[MASS_ONLY]), "iterations": float(report[4]), "residual": float(report[5]),
    }  # fmt: skip


def held(stages: Stages) -> float:
    """Half the heights that faces hold back, for half of the particles look their way; per dx."""
    h, e, theta = stages.ghosted("h"), stages["e"], stages["theta"]
    back = np.minimum(theta * np.maximum(-e, 0.0), h[:-1])
    forth = np.minimum(theta * np.maximum(e, 0.0), h[1:])
    return 0.5 * float(math.fsum(back) + math.fsum(forth))


def departure(density: Density, h: Array, q: Array, dx: float) -> dict[str, float]:
    """How f, after the force, departs from the new state (h, q) and from its equilibrium."""
    M, f = density.equilibrium(h, mean_velocity(q, h)), density.f
    if density.offset.any():
        f = moved(f, density.offset, density.grid.dxi)
    cell = density.grid.dxi * dx
    row_mass = density.f.sum(axis=1)
    momentum = math.fsum(density.f @ density.xi + density.offset * row_mass)
    return {
        "sampling_mass": math.fsum(row_mass) * cell - math.fsum(h) * dx,
        "sampling_momentum": momentum * cell - math.fsum(q) * dx,
        "f_distance": float(np.abs(f - M).sum()) * cell,
        "f_tail": float(f[M == 0.0].sum()) * cell,
    }
