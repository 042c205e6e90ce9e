"""The moment ledger: what each stage of a step did to mass, momentum, energy and kinetic entropy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..balance.stages import Array, Stages
from ..checkpoint import Kept
from ..kernel import kernel
from ..kinetic.velocity import Grid
from ..kinetic.wing import Density
from ..local import Local, at
from ..scene import Scene
from ..stepper import Stepper

if TYPE_CHECKING:
    import xarray

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


class Causes:
    """Follows the four quantities through the stages of every step of a run.

    For a state U they are h, q, q^2/h + beta h^2/2 and q^2/(2h) + beta h^2/2, for a density the sums over its nodes.
    The causes of a step add up to its total change, and so do the sums over all steps, to rounding.
    """

    def __init__(self, scene: Scene, stepper: Stepper, density: Density) -> None:
        self._scene, self._stepper, self._density = scene, stepper, density
        self._last = np.zeros((len(STAGES), len(QUANTITIES)))
        self._sum = np.zeros_like(self._last)
        self._saved: list[tuple[float, Array, Array, Change]] = []
        self._first: Change | None = None

    def note(self, h1: Array, q1: Array, dt: float) -> None:
        """A step was taken to (h1, q1); the stages still hold it."""
        now, density = self._stepper.now, self._density
        before = self.of_state(now.h[1:-1], now.q)
        if self._first is None:
            self._first = before
        of_M, cut = self._sampled(now)
        transported = self._of(density.transported)
        boundary = self._boundary(now, dt)
        forced = self._of(density.f, density.offset)
        left = self._left_window(now)
        after = self.of_state(h1, q1)
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

    def _of(self, f: Array, offset: Array | None = None, grid: Grid | None = None) -> Change:
        """The four quantities of a density, integrated over x and xi."""
        grid = grid or self._density.grid
        moved = np.zeros(f.shape[0]) if offset is None else offset
        cell = grid.dxi * self._scene.cells.dx
        return cell * np.array(quantities(f, grid.xi, moved, self._scene.beta, 0))

    def _sampled(self, now: Stages) -> tuple[Change, Change]:
        """Of M^n, and what the window cut from it."""
        density = self._density
        inside = self._of(density.M[1:-1])
        if density.reach <= density.grid.bound:
            return inside, np.zeros(len(QUANTITIES))
        wide = Grid(2 * math.ceil(density.reach / density.grid.dxi), density.grid.dxi)
        return inside, inside - self._of(density.on_grid(wide, now), grid=wide)

    def _left_window(self, now: Stages) -> Change:
        """What the force pushed out of the window: the change that a window without edge would not have seen."""
        density = self._density
        if density.lost == 0.0:
            return np.zeros(len(QUANTITIES))
        height = np.where(now.h1 > 0, now.h1, np.inf)
        far = float(np.max(np.abs(now.J) / height)) / density.grid.dxi
        extra = min(math.ceil(far) + 2, 4 * density.grid.count)
        wide = Grid(density.grid.count + 2 * extra, density.grid.dxi)
        return self._of(density.f, density.offset) - self._of(density.forced_on(wide, now), density.offset, wide)

    def _boundary(self, now: Stages, dt: float) -> Change:
        if self._scene.boundary == "periodic":
            return np.zeros(len(QUANTITIES))
        density, half = self._density, self._density.grid.half
        ends = []
        for face, balanced in ((0, now.at_left[0]), (now.q.size, now.at_right[-1])):
            upwind = np.concatenate([density.M[face + 1, :half], density.M[face, half:]])
            row = density.B[face] if balanced else upwind
            ends.append(np.array(quantities(row[None, :], density.xi, np.zeros(1), self._scene.beta, 1)))
        change: Change = dt * density.grid.dxi * (ends[0] - ends[1])
        return change


@kernel
def quantities(f: Array, xi: Array, offset: Array, beta: Local, flux: int) -> tuple[float, float, float, float]:
    """Sums of f, xi f, xi^2 f and H(f, xi), times xi if `flux` is 1; node j of row i stands at xi_j + offset_i."""
    m0, m1, m2, entropy = 0.0, 0.0, 0.0, 0.0
    for i in range(f.shape[0]):
        cubic = np.pi * np.pi * at(beta, i) * at(beta, i) / 6.0
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
