"""Pictures of what scheme 4 promises: on dry ground, down a slope, and at the edge of standing.

- A column breaks on dry ground, spreads, and stops: u is 0 exactly, and what is bare stays bare.
- A cap slides down a slope steeper than its friction angle, and leaves nothing behind: the exact solution is a
  parabola that moves as a whole.
- A pile as steep as friction holds stands; the ground tilted by one degree more, with the same pile, and it comes down.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from claims import Chapter, run
from laboratory.pictures import COLOURS
from laboratory.repaired import courant
from matplotlib.figure import Figure

from kinsim import Cells, ConstantSlope, Coulomb, Courant, Macroscopic, Profile, Run, Scene, load_scene, simulate
from kinsim.exact import ParabolicCap, StaticPile
from kinsim.mean import mean_velocity

FIRST, SECOND = Macroscopic(4), Macroscopic(4, order=2)
DEGREE = math.pi / 180


def main(chapter: Chapter) -> None:
    """Three pictures."""
    finer = 2 if chapter.full else 1
    chapter.figure(breaking(chapter, 200 * finer), "silo", "A column on dry ground, from the start to rest.")
    chapter.figure(sliding(chapter, 200 * finer), "cap", "A cap slides down and leaves nothing behind.")
    chapter.figure(standing(chapter, 120 * finer), "pile", "A pile that stands, and the same pile one degree steeper.")


def breaking(chapter: Chapter, count: int) -> Figure:
    """The silo of the paper, on dry ground."""
    silo = replace(load_scene("silo")[0], cells=Cells(-7, 7, count))
    silo = replace(silo, heap=Profile(np.where(np.abs(silo.x) < 1, 2.3, 0.0)))
    figure, panels = _panels(2)
    for axes, method, name in zip(panels, (FIRST, SECOND), ("first order", "second order"), strict=True):
        one = simulate(silo, method, Courant(courant(method), 12.0), 1)
        moving = np.flatnonzero((one.q != 0).any(axis=1))
        stopped = float(one.t[moving[-1] + 1])
        times = (0.0, 0.5, 1.0, 2.0, stopped)
        _curves(axes, one, times)
        axes.set_title(f"{name}: u = 0 everywhere from t = {stopped:.2f}", loc="left", fontsize=10)
        steep = np.abs(np.diff(one.h[-1])).max() * silo.beta / silo.cells.dx / silo.resistance
        chapter.claim(f"silo on dry ground, {name}: largest |q| at the end", np.abs(one.q[-1]).max(), high=0.0)
        chapter.claim(
            f"silo on dry ground, {name}: steepest face at the end over what friction holds", steep, high=1.001
        )
        chapter.claim(
            f"silo on dry ground, {name}: least h of all steps", one.entries["h_min"].min(), low=0.0, high=0.0
        )
        chapter.claim(f"silo on dry ground, {name}: change of mass", abs(one.mass_drift), high=1e-14)
    return figure


def sliding(chapter: Chapter, count: int) -> Figure:
    """A cap on ground that is steeper than its friction angle."""
    cap = ParabolicCap(1.0, 1.0, 0.35, pull=0.5, resistance=0.2, u0=1.2, x0=-2.0)
    zeta = math.asin(cap.pull)
    cells, end = Cells(-4, 6, count), 2.0
    h, q = cap.averages(cells, 0.0)
    scene = Scene(cells, Profile(h, mean_velocity(q, h)), ConstantSlope(zeta),
                  Coulomb(math.atan(cap.resistance / math.cos(zeta))), epsilon=cap.beta / math.cos(zeta))  # fmt: skip
    figure, panels = _panels(2)
    for axes, method, name in zip(panels, (FIRST, SECOND), ("first order", "second order"), strict=True):
        one = simulate(scene, method, Courant(courant(method), end), 1)
        times = (0.0, 1.0, end)
        _curves(axes, one, times)
        x = np.linspace(-4, 6, 1001)
        for t in times:
            axes.plot(x, cap(x, t)[0], color="black", linewidth=0.9, linestyle=":", label="exact" if t == 0 else None)
        axes.legend(frameon=False, fontsize=8)
        middle, half, _ = cap.shape(end)
        behind = float(one.h[-1][one.x < middle - half - 3 * cells.dx].sum() * cells.dx)
        mass = float(h.sum() * cells.dx)
        off = float(np.abs(one.h[-1] - cap.averages(cells, end)[0]).sum() * cells.dx)
        axes.set_title(f"{name}: left behind {behind / mass:.1e} of the mass", loc="left", fontsize=10)
        chapter.claim(
            f"cap, {name}: mass more than three cells behind the rear, over the mass", behind / mass, high=0.02
        )
        chapter.claim(f"cap, {name}: L1(h) at t = 2 over the mass", off / mass, high=0.1 if method is FIRST else 0.03)
        chapter.claim(f"cap, {name}: least h of all steps", one.entries["h_min"].min(), low=0.0, high=0.0)
    return figure


def standing(chapter: Chapter, count: int) -> Figure:
    """A pile at 99.9 percent of the bound, zeta = 8 degrees, delta = 20 degrees; and zeta = 9 degrees."""
    delta, zeta = 20 * DEGREE, 8 * DEGREE
    figure, panels = _panels(2)
    cells = Cells(0, 6, count)
    s, R, beta = math.sin(zeta), math.cos(zeta) * math.tan(delta), 0.4 * math.cos(zeta)
    pile = StaticPile(0.999, -0.999, beta, pull=s, resistance=R, h0=1.0, x0=2.4)
    h = pile.averages(cells, 0.0)[0]
    for axes, tilt in zip(panels, (0.0, DEGREE), strict=True):
        scene = Scene(cells, Profile(h), ConstantSlope(zeta + tilt), Coulomb(delta), "open", 0.4)
        one = simulate(scene, FIRST, Courant(0.9, 30.0), 1)
        moved = float(np.abs(one.h[-1] - h).max())
        moving = np.flatnonzero((one.q != 0).any(axis=1))
        last = float(one.t[moving[-1] + 1]) if moving.size else 0.0
        _curves(axes, one, (0.0, last) if moving.size else (0.0,))
        degrees = round((zeta + tilt) / DEGREE)
        what = f"moves until t = {last:.2f}" if moving.size else "stands, bit for bit"
        axes.set_title(f"zeta = {degrees}°, delta = 20°: {what}", loc="left", fontsize=10)
        chapter.claim(
            f"pile, zeta = {degrees} degrees: largest change of h", moved, **({"low": 1e-3} if tilt else {"high": 0.0})
        )
        chapter.claim(f"pile, zeta = {degrees} degrees: largest |q| at the end", np.abs(one.q[-1]).max(), high=0.0)
    return figure


def _panels(count: int) -> tuple[Figure, Any]:
    figure = Figure(figsize=(12, 3.8), layout="constrained")
    return figure, figure.subplots(1, count, sharex=True, sharey=True)


def _curves(axes: Any, one: Run, times: tuple[float, ...]) -> None:
    """h at the saved times nearest to `times`, where it is more than 0.001."""
    for number, t in enumerate(times):
        k = int(np.argmin(np.abs(one.t - t)))
        axes.plot(one.x, np.where(one.h[k] > 1e-3, one.h[k], np.nan), ("-", "--", "-.", ":", "-")[number],
                  color=COLOURS[number], linewidth=1.7, label=f"t = {one.t[k]:.2f}")  # fmt: skip
    axes.axhline(0, color="0.4", linewidth=1)
    axes.set(xlabel="x (dimensionless)", ylabel="height h")
    axes.legend(frameon=False, fontsize=8)
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)


if __name__ == "__main__":
    run(main, __doc__)
