"""The moment ledger: what each stage of a step did to mass, momentum, energy and kinetic entropy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..checkpoint import Kept
from ..compiled import kernel
from ..errors import InputError
from ..kinetic.velocity import Grid
from ..model.ground import Flat
from ..scene import Scene
from .observer import Observer

if TYPE_CHECKING:
    import xarray

    from ..solver.density import Density
    from ..solver.solver import Block, Solver
    from ..solver.stages import Stages

STAGES = {
    "sampling": "from U^n to M^n on the grid",
    "transport": "transport between cells, and what mixed faces make",
    "boundary": "transport through the two ends",
    "force": "the impulse on f",
    "window": "what left the velocity window, or was cut by it",
    "projection": "from f to U^{n+1}",
}

QUANTITIES = {
    "mass": "sum of f",
    "momentum": "sum of xi f",
    "energy": "sum of xi^2 f",
    "entropy": "sum of H(f, xi) = xi^2 f/2 + (pi^2 beta^2/6) f^3",
}

Change = Array
"""One number per quantity, shape (4,)."""


class Causes(Observer):
    """Follows the four quantities through the stages of every step of a run.

    For a state U they are h, q, q^2/h + beta h^2/2 and q^2/(2h) + beta h^2/2, for a density the sums over its nodes.
    The causes of a step add up to its total change, and so do the sums over all steps, to rounding.

    Raises:
        InputError: The run is not one of first order on a constant slope.
    """

    name, every = "causes", 1

    def __init__(self, scene: Scene, order: int) -> None:
        if not isinstance(scene.ground, Flat):
            raise InputError("the moment ledger is one of a constant slope; leave out causes on a smooth chute")
        if order == 2:
            raise InputError("the moment ledger is one of first order; take order 1, or leave out causes")
        self._scene = scene
        self._last = np.zeros((len(STAGES), len(QUANTITIES)))
        self._sum = np.zeros_like(self._last)
        self._saved: list[tuple[float, Array, Array, Change]] = []
        self._first: Change | None = None

    def start(self, solver: Solver) -> None:
        self._first = self.of_state(solver.h, solver.q)

    def look(self, block: Block) -> None:
        stages, density = block.stages, block.stages.density
        before, after = self.of_state(stages["h"], stages["q"]), self.of_state(block.h, block.q)
        of_M, cut = self._sampled(density)
        transported = self._of(density.transported, density)
        boundary = self._boundary(density, stages.dt)
        forced = self._of(density.f, density, density.offset)
        left = self._left_window(stages)
        self._last = np.array([
            of_M - before - cut,
            transported - of_M - boundary,
            boundary,
            forced - transported - left,
            cut + left,
            after - forced,
        ])  # fmt: skip
        self._sum += self._last

    def save(self, t: float, h: Array, q: Array) -> None:
        """Keep the books of the last step and of all steps up to the time t, at which the state is (h, q)."""
        now = self.of_state(h, q)
        total = now - self._first if self._first is not None else np.zeros_like(now)
        self._saved.append((t, self._last.copy(), self._sum.copy(), total))

    def kept(self) -> Kept:
        """The books so far."""
        t, step, summed, total = (np.array(column) for column in zip(*self._saved, strict=True))
        first = np.empty((0, len(QUANTITIES))) if self._first is None else self._first[None]
        return {"last": self._last, "sum": self._sum.copy(), "first": first,
                "t": t, "steps": step, "sums": summed, "totals": total}  # fmt: skip

    def restore(self, kept: Kept) -> None:
        """Go on from there."""
        self._last, self._sum = kept["last"], kept["sum"]
        self._first = kept["first"][0] if kept["first"].size else None
        columns = (kept["t"].tolist(), kept["steps"], kept["sums"], kept["totals"])
        self._saved = list(zip(*columns, strict=True))

    def result(self) -> xarray.Dataset:
        """`step`: the last step before each saved time; `sum`: all steps so far; `total`: change of the state."""
        import xarray

        t, step, summed, total = (np.array(column) for column in zip(*self._saved, strict=True))
        axes = ("t", "stage", "quantity")
        return xarray.Dataset(
            {
                "step": (axes, step, {"long_name": "change by each stage in the last step", "units": "1"}),
                "sum": (axes, summed, {"long_name": "change by each stage so far", "units": "1"}),
                "total": (("t", "quantity"), total, {"long_name": "change of the state so far", "units": "1"}),
            },
            coords={"t": t, "stage": list(STAGES), "quantity": list(QUANTITIES)},
        )

    def of_state(self, h: Array, q: Array) -> Change:
        """The four quantities of a state, integrated over x."""
        work = np.divide(q * q, h, out=np.zeros_like(q), where=h > 0)
        pressure = 0.5 * self._scene.beta * h * h
        sums = (h, q, work + pressure, 0.5 * work + pressure)
        return self._scene.cells.dx * np.array([math.fsum(column) for column in sums])

    def _of(self, f: Array, density: Density, offset: Array | None = None) -> Change:
        """The four quantities of a density, integrated over x and xi."""
        grid: Grid = density.grid
        moved = np.zeros(f.shape[0]) if offset is None else offset
        cell = grid.dxi * self._scene.cells.dx
        return cell * np.array(quantities(f, grid.xi, moved, float(self._scene.beta), 0))

    def _sampled(self, density: Density) -> tuple[Change, Change]:
        """Of M^n, and what the window cut from it."""
        inside = self._of(density.M, density)
        if density.reach <= density.grid.bound:
            return inside, np.zeros(len(QUANTITIES))
        wide = density.wider(density.reach)
        return inside, inside - self._of(wide.M, wide)

    def _left_window(self, stages: Stages) -> Change:
        """What the force pushed out of the window: the change that a window without edge would not have seen."""
        density = stages.density
        if density.lost == 0.0:
            return np.zeros(len(QUANTITIES))
        height = np.where(stages["h1"] > 0, stages["h1"], np.inf)
        far = float(np.max(np.abs(stages["J"]) / height))
        extra = min(far + 2.0 * density.grid.dxi, 4.0 * density.grid.count * density.grid.dxi)
        wide = density.wider(density.grid.bound + extra)
        wide = wide.pushed_from(density)
        return self._of(density.f, density, density.offset) - self._of(wide.f, wide, density.offset)

    def _boundary(self, density: Density, dt: float) -> Change:
        if self._scene.boundary == "periodic":
            return np.zeros(len(QUANTITIES))
        beta = float(self._scene.beta)
        ends = [np.array(quantities(row[None, :], density.xi, np.zeros(1), beta, 1)) for row in density.ends]
        change: Change = dt * density.grid.dxi * (ends[0] - ends[1])
        return change


@kernel
def quantities(f: Array, xi: Array, offset: Array, beta: float, flux: int) -> tuple[float, float, float, float]:
    """Sums of f, xi f, xi^2 f and H(f, xi), times xi if `flux` is 1; node j of row i stands at xi_j + offset_i."""
    m0, m1, m2, entropy = 0.0, 0.0, 0.0, 0.0
    for i in range(f.shape[0]):
        cubic = np.pi * np.pi * beta * beta / 6.0
        r0, r1, r2, r3 = 0.0, 0.0, 0.0, 0.0
        for j in range(xi.size):
            v = xi[j] + offset[i]
            weight = v if flux == 1 else 1.0
            g = weight * f[i, j]
            r0 += g
            r1 += v * g
            r2 += v * v * g
            r3 += weight * f[i, j] * f[i, j] * f[i, j]
        m0 += r0
        m1 += r1
        m2 += r2
        entropy += 0.5 * r2 + cubic * r3
    return m0, m1, m2, entropy
