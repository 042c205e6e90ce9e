"""The mass that scheme 3 makes and loses as printed, explained face by face.

Each cell chooses F or F~ for itself. Where a slow cell and a fast one meet, one face carries two fluxes: what leaves
one cell is not what enters the other. Per step such a mixed face makes the mass

    dt (F - F~)   if the cell on its left is slow,    dt (F~ - F)   if the one on its right is.

Which cells are slow is derived anew, too, by quadrature (`laboratory/slow.py`).
Summed over all mixed faces and all steps, with the fluxes of each step computed anew from the saved states, this is the
whole drift of the total mass, to 1e-13 of the mass: what is left is the rounding of the heights, as large as the drift
with one flux per face, coupling="face", where nothing is made.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from claims import Chapter, run
from laboratory.pictures import COLOURS
from laboratory.slow import slow_cells
from matplotlib.colors import SymLogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from kinsim import Macroscopic, Run, load_scene, simulate, step

Array = NDArray[np.float64]
SCENES = {
    "silo": (0.003, 0.007, 0.5), "silo-incline": (0.006, 0.012, 0.5), "parabola": (0.005, 0.009, 0.75),
    "sine": (-0.003, -0.001, 1.0),
}  # fmt: skip
"""Bounds of drift over mass, about +0.5, +0.9, +0.7 and -0.2 percent, and the share of the steps with motion."""


@dataclass(frozen=True)
class Explained:
    """A run and what its mixed faces made.

    Attributes:
        one: The run, every step of it.
        made: Mass made by each inner face in each step, shape (steps, nx - 1).
        entered: Mass that entered through both ends in each step, shape (steps,).
        misjudged: Inner cells that an independent derivation of slow cells judges otherwise, every 50 steps.
    """

    one: Run
    made: Array
    entered: Array
    misjudged: int

    @property
    def drift(self) -> float:
        """Change of the total mass that did not enter through the ends."""
        h, dx = self.one.h, self.one.scene.cells.dx
        return math.fsum([*(dx * h[-1]), *(-dx * h[0]), *(-self.entered)])

    @property
    def mass(self) -> float:
        """Mass at the start."""
        return math.fsum(self.one.h[0]) * self.one.scene.cells.dx


def explain(name: str, share: float) -> Explained:
    """Take every step of a run anew and look at its faces."""
    scene, _, clock = load_scene(name)
    method = Macroscopic(3)
    clock = type(clock)(clock.dt, round(share * clock.steps))
    one = simulate(scene, method, clock, 1)
    made, entered, misjudged = np.zeros((clock.steps, scene.cells.count - 1)), np.zeros(clock.steps), 0
    for n in range(clock.steps):
        now = step(scene, method, one.h[n], one.q[n], clock.dt)
        if n % 500 == 0 and not np.array_equal(now.h1, one.h[n + 1]):
            raise AssertionError("a step taken anew is not the step of the run")
        F, B, slow = now.flux[0], now.balanced_flux[0], now.slow
        if n % 50 == 0:
            misjudged += int((slow[1:-1] != slow_cells(scene, one.h[n], one.q[n], clock.dt)).sum())
        two = clock.dt * (F[1:-1] - B[1:-1])
        made[n] = np.where(slow[:-1] & ~slow[1:], two, 0.0) - np.where(~slow[:-1] & slow[1:], two, 0.0)
        entered[n] = clock.dt * ((B if slow[0] else F)[0] - (B if slow[-1] else F)[-1])
    return Explained(one, made, entered, misjudged)


def main(chapter: Chapter) -> None:
    """All four scenes in which something is slow."""
    found, rows = {}, []
    for name, (low, high, share) in SCENES.items():
        found[name] = it = explain(name, 1.0 if chapter.full else share)
        explained = math.fsum(it.made[it.made != 0.0])
        face = simulate(it.one.scene, Macroscopic(3, "face"), it.one.clock, it.one.clock.steps)
        chapter.claim(f"{name}: drift over the mass", it.drift / it.mass, low=low, high=high)
        chapter.claim(f"{name}: sum over mixed faces less drift, over the mass", abs(explained - it.drift) / it.mass,
                      high=1e-13)  # fmt: skip
        chapter.claim(
            f"{name}: sum over mixed faces less drift, over the drift", abs(explained / it.drift - 1), high=1e-11
        )
        chapter.claim(f"{name}, one flux per face: drift over the mass", abs(face.mass_drift), high=1e-13)
        chapter.claim(f"{name}: slow cells that an independent derivation judges otherwise, in every 50th step",
                      it.misjudged, low=0, high=0)  # fmt: skip
        mixed = it.made != 0.0
        rows.append([name, it.one.steps, 100 * it.drift / it.mass, 100 * explained / it.mass, int(mixed.sum()),
                     int(mixed.any(axis=1).sum()), 100 * face.mass_drift])  # fmt: skip
    heads = ("scene", "steps", "drift", "sum over mixed faces", "mixed faces", "steps with one", "one flux per face")
    chapter.table("Drift of the printed scheme 3, percent of the mass", heads, rows)
    chapter.figure(draw(found), "faces", "The drift over time, and the faces that make it.")


def draw(found: dict[str, Explained]) -> Figure:
    """Left drift and sum over time, right which faces made how much in `silo`."""
    figure = Figure(figsize=(12.5, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    for number, (name, it) in enumerate(found.items()):
        dx = it.one.scene.cells.dx
        gone = (it.one.h.sum(axis=1) - it.one.h[0].sum()) * dx - np.concatenate([[0], np.cumsum(it.entered)])
        made = np.concatenate([[0], np.cumsum(it.made.sum(axis=1))])
        left.plot(it.one.t, 100 * gone / it.mass, color=COLOURS[number], linewidth=4, alpha=0.35)
        left.plot(it.one.t, 100 * made / it.mass, color=COLOURS[number], linewidth=1.2, linestyle="--")
        left.annotate(name, (it.one.t[-1], 100 * gone[-1] / it.mass), xytext=(-2, 6), textcoords="offset points",
                      color=COLOURS[number], fontsize=9, ha="right")  # fmt: skip
    left.axhline(0, color="0.6", linewidth=1)
    left.set_title("drift of the mass; dashed: sum over mixed faces", loc="left", fontsize=10)
    left.set(xlabel="t (dimensionless)", ylabel="percent of the mass")
    left.grid(alpha=0.25)
    left.spines[["top", "right"]].set_visible(False)
    it = found["silo"]
    late = it.one.t[:-1] < 6.0
    made = it.made[late]
    blocks = made[: len(made) // 20 * 20].reshape(-1, 20, made.shape[1]).sum(axis=1)
    faces = it.one.scene.cells.left + it.one.scene.cells.dx * np.arange(1, it.one.scene.cells.count)
    top = float(np.abs(blocks).max())
    scale = SymLogNorm(1e-3 * top, vmin=-top, vmax=top)
    t = it.one.t[: 20 * len(blocks) : 20]
    image = right.pcolormesh(faces, t, blocks, cmap="PuOr", norm=scale, shading="nearest", rasterized=True)
    figure.colorbar(image, ax=right, label="mass made in 20 steps", pad=0.01)
    right.set_title("silo: the mixed faces", loc="left", fontsize=10)
    right.set(xlabel="x (dimensionless)", ylabel="t", xlim=(-5, 5))
    return figure


if __name__ == "__main__":
    run(main, __doc__)
