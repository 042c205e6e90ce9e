"""The trade between speed and accuracy on the five scenes of the paper, and where each refinement stops paying.

`kinsim.trade` runs each scene over a family of methods: velocity grids of 8 to 256 nodes, sampled and by cell
averages, fitted nodes, other forces, other dx, shorter steps, second order. Each member is timed alone, in turn with
the others. Velocity errors are L1(h) to the closed-form twin, total errors L1(h) to the exact solution or to second
order on four times the finest cells, both at the scene's end and over its mass.

What has to hold on any machine is claimed: velocity errors fall at least as theory says of the half-range fluxes
(n^-1.5 sampled, n^-2 by cell averages, geometrically for fitted nodes), total errors fall with dx and with the order,
no shift of the force makes a difference (only (h, q) is handed on), and the mass is kept, but for sampled grids too
coarse for a thin layer, whose f holds another mass than h: there cells can run empty. Times are in the tables;
they are of the machine that made them. `--full` takes
all five scenes, the whole family, and five rounds of timing.
"""

from __future__ import annotations

import numpy as np
import xarray
from claims import Chapter, run
from rich.console import Console
from rich.progress import track

from kinsim import Kinetic, budget, load_scene, trade
from kinsim.plot import draw_trade
from kinsim.trades.family import NUMBER
from kinsim.trades.pace import steady

SCENES = ("riemann", "silo", "silo-incline", "parabola", "sine")
SMALL = ("closed form", "cell average", "sampled", "fitted", "dx", "order")
"""Lines of the small size."""

BUDGETS = (Kinetic(), Kinetic(velocity={"kind": "fitted", "count": 2}))


def main(chapter: Chapter) -> None:
    """Each scene: claims, a table of what is worth its cost, a picture, a budget."""
    budgets = []
    for name in track(SCENES if chapter.full else SCENES[::3], console=Console(stderr=True), transient=True):
        scene, _, clock = load_scene(name)
        found = trade(
            scene, Kinetic(), clock, lines=None if chapter.full else SMALL, repeats=5 if chapter.full else 1,
            keep=chapter.out / "trade" if chapter.full else None, resume=chapter.full,
        )  # fmt: skip
        claims(chapter, name, found)
        chapter.table(f"{name}: what is worth its cost; errors are judged by {found.attrs['judge']}", HEADS, rows(
            found.isel(member=np.flatnonzero(found["pareto"].to_numpy())).sortby("wall_time")))  # fmt: skip
        same = found.isel(member=np.flatnonzero((found["cells"] == scene.cells.count) & (found["courant"] == NUMBER)))
        chapter.table(f"{name}: all members on {scene.cells.count} cells, first order", HEADS, rows(same))
        chapter.figure(draw_trade(found), name, f"{name}: cost against error.")
        pace = steady(scene, Kinetic(), NUMBER, clock.end)
        if chapter.full:
            for method in BUDGETS:
                budgets.append([name, method.velocity.words, budget(scene, method, pace).words])
    if budgets:
        chapter.table("Error budgets at Courant number 0.8", ("scene", "nodes", "budget"), budgets)


HEADS = ("method", "cells", "Courant", "ms", "from", "to", "ns per cell and step", "memory, kB",
         "velocity error", "total error", "rest residual")  # fmt: skip


def rows(found: xarray.Dataset) -> list[list[object]]:
    """A row for each member."""
    made: list[list[object]] = []
    for at in range(found.sizes["member"]):
        one = found.isel(member=at)
        method = str(one["method"].item()).replace(", scheme 4", "")
        made.append([
            method + (" (knee)" if bool(one["knee"]) else ""), int(one["cells"]), float(one["courant"]),
            *(1e3 * float(one[f"wall_time{end}"]) for end in ("", "_low", "_high")), float(one["ns_per_cell_step"]),
            float(one["memory"]) / 1e3,
            *(float(one[name]) for name in ("velocity_error", "total_error", "rest_residual")),
        ])  # fmt: skip
    return made


def claims(chapter: Chapter, name: str, found: xarray.Dataset) -> None:
    """What has to hold on any machine."""
    line, error = found["line"].to_numpy(), found["velocity_error"].to_numpy()
    total, cells, order = (found[key].to_numpy() for key in ("total_error", "cells", "order"))
    stopped = np.isnan(found["wall_time"].to_numpy()).sum()
    chapter.claim(f"{name}: members that did not come to the end", float(stopped), high=0.0)
    for kind, theory in (("cell average", -2.0), ("sampled", -1.5)):
        n = found["nodes"].to_numpy()[line == kind]
        slope = np.polyfit(np.log(n), np.log(error[line == kind]), 1)[0]
        chapter.claim(f"{name}: order of the velocity error in n, {kind}", slope, high=theory + 0.3)
    fitted = error[line == "fitted"]
    chapter.claim(f"{name}: velocity error of 4 fitted nodes over that of 3", fitted[3] / fitted[2], high=0.1)
    for one in (1, 2):
        closed = np.isin(line, ("closed form", "dx", "order")) & (found["nodes"].to_numpy() == 0) & (order == one)
        falling = total[closed][np.argsort(cells[closed])]
        chapter.claim(f"{name}: total error at dx over that at 2 dx, worst, order {one}",
                      float(np.max(falling[1:] / falling[:-1])), high=1.0)  # fmt: skip
    two = error[(line == "fitted") & (found["nodes"].to_numpy() == 2)][0]
    sentence = f"{name}: velocity error of 2 fitted nodes over the least total error of all"
    chapter.claim(sentence, two / np.nanmin(total), high=0.1)
    few = error[(line == "cell average") & (found["nodes"].to_numpy() == 32)][0]
    many = error[(line == "sampled") & (found["nodes"].to_numpy() == 128)][0]
    chapter.claim(f"{name}: velocity error of 32 nodes, cell averages, over that of 128 sampled", few / many, high=1.0)
    drift = np.abs(found["mass_drift"].to_numpy())[line != "sampled"]
    chapter.claim(f"{name}: mass drift, worst but for sampled grids", float(np.nanmax(drift)), high=1e-13)
    shifts = error[(line == "force") & np.char.startswith(found["method"].to_numpy().astype(str), "kinetic")]
    if shifts.size:
        base = error[(line == "cell average") & (found["nodes"].to_numpy() == 64)][0]
        chapter.claim(f"{name}: velocity error with the exact shift less that with the linear one",
                      abs(float(shifts[0]) - float(base)), high=1e-14)  # fmt: skip


if __name__ == "__main__":
    run(main, __doc__)
