"""The projection (20) read in two ways, thin films, windows that follow, and what the moment ledger shows.

After each step the density is forgotten but for (h, q), (20). On a grid this can be read as sums over f taken anew, or
as U^n - lam (F_{i+1/2} - F_{i-1/2}) + J with the half-range sums F. Both are the same in the continuum, and on the grid
wherever the discrete M carries (h, q) exactly. Where it does not:

- a film whose support is thinner than a velocity cell gets a false velocity of up to dxi/2 from the sums;
- sampled M creates or destroys mass in each step.

A window that follows the occupied velocities costs what the support costs; what leaves a window that does not follow
is booked. The moment ledger tells which stage changed mass, momentum, energy and entropy.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from claims import Chapter, run
from laboratory.measures import made_drift, make_case, unbooked_drift
from laboratory.pictures import COLOURS
from matplotlib.figure import Figure
from numpy.typing import NDArray

from kinsim import Cells, Frictionless, Kinetic, Profile, Scene, Uniform, load_scene, simulate, step
from kinsim.diagnostics.causes import STAGES
from kinsim.kinetic.equilibrium import EQUILIBRIA
from kinsim.kinetic.force import FORCES
from kinsim.kinetic.velocity import Window
from kinsim.rooms import PROJECTIONS

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)
DXI = 0.1


def main(chapter: Chapter) -> None:
    """One reading after the other."""
    false = films(chapter)
    chapter.figure(draw_films(false), "films", "The velocity that a thin film has after one step of rest.")
    two_readings(chapter)
    windows(chapter, 4 if not chapter.full else 1)
    changes = ledger(chapter, 4 if not chapter.full else 1)
    chapter.figure(draw_ledger(changes), "ledger", "What each stage did to energy and entropy, default variant.")


# ---- films -----------------------------------------------------------------------------------------------------------


def films(chapter: Chapter) -> dict[tuple[str, str], tuple[Array, Array]]:
    """A uniform film, no force, its support a thousandth of a velocity cell: its velocity after one step."""
    h = (1e-3 * DXI) ** 2 / 0.8  # c = sqrt(2 beta h) = 1e-3 dxi
    u = np.linspace(0.0, 3.0 * DXI, 121)
    found = {}
    for projection in PROJECTIONS:
        for name in EQUILIBRIA:
            after = np.array([_after_a_step(h, v, name, projection) for v in u])
            found[name, projection] = (u, after)
    for (name, projection), (_, after) in found.items():
        off = np.abs(after - u) / DXI
        if projection == "flux-difference" or name in ("matched", "entropic"):
            chapter.claim(f"film, {projection}, {name}: false velocity over dxi", np.nanmax(off), high=1e-10)
        elif name == "cell-average":
            chapter.claim(f"film, {projection}, {name}: false velocity over dxi, up to one half", np.nanmax(off),
                          low=0.4, high=0.501)  # fmt: skip
    lost = float(np.isnan(found["sampled", "re-summed"][1]).mean())
    chapter.claim("film, re-summed, sampled: share of velocities at which the film is lost altogether", lost, low=0.9)
    return found


def _after_a_step(h: float, u: float, equilibrium: Any, projection: Any) -> float:
    """The velocity of a uniform film after one step without force; NaN where the film is gone."""
    scene = Scene(
        Cells(0, 1, 8), Profile(np.full(8, h), np.full(8, u)), friction=Frictionless(), boundary="periodic", epsilon=0.4
    )
    method = Kinetic(1, Uniform(16, 8 * DXI), equilibrium, projection=projection)
    after = step(scene, method, *scene.initial(), 1e-3)
    return float(after.q1[4] / after.h1[4]) if after.h1[4] > 0.0 else float("nan")


def draw_films(found: dict[tuple[str, str], tuple[Array, Array]]) -> Figure:
    """Velocity after against before."""
    figure = Figure(figsize=(7.2, 5.2), layout="constrained")
    axes = figure.subplots()
    u, exact = found["cell-average", "flux-difference"]
    _, false = found["cell-average", "re-summed"]
    axes.plot(u / DXI, false / DXI, color=COLOURS[1], linewidth=1.8)
    axes.plot(u / DXI, exact / DXI, color=COLOURS[0], linewidth=1.8)
    axes.annotate("cell averages, re-summed:\nthe middle of the velocity cell", (2.02, 2.5), xytext=(1.05, 2.65),
                  color=COLOURS[1], fontsize=9.5, arrowprops={"arrowstyle": "-", "color": COLOURS[1]})  # fmt: skip
    axes.annotate("flux differences (any equilibrium),\nmatched and entropic (either reading):\nthe true velocity",
                  (1.75, 1.75), xytext=(1.65, 0.85), color=COLOURS[0], fontsize=9.5,
                  arrowprops={"arrowstyle": "-", "color": COLOURS[0]})  # fmt: skip
    axes.set(xlabel="velocity of the film before, u/dxi", ylabel="velocity after one step without any force, u/dxi")
    axes.set_title("A film much thinner than a velocity cell", loc="left", fontsize=11)
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    return figure


# ---- the two readings in a run ---------------------------------------------------------------------------------------


def two_readings(chapter: Chapter) -> None:
    """Mass that sums taken anew make or destroy in a run; the other reading keeps it whatever M is."""
    case = make_case("silo", 4, 250)
    rows = []
    for name in EQUILIBRIA:
        drifts = {}
        for projection in PROJECTIONS:
            method = Kinetic(3, Uniform(64, 1.1 * case.bound), name, projection=projection)
            drifts[projection] = made_drift(simulate(case.scene, method, case.clock, case.clock.steps))
        rows.append([name, *drifts.values()])
        chapter.claim(f"silo, {name}, flux differences: mass drift", drifts["flux-difference"], high=250 * EPS)
        if name == "sampled":
            chapter.claim("silo, sampled, re-summed: mass drift", drifts["re-summed"], low=1e-4)
        else:
            chapter.claim(f"silo, {name}, re-summed: mass drift", drifts["re-summed"], high=250 * 64 * EPS)
    chapter.table("Mass drift, silo, 80 cells, 250 steps, 64 nodes", ("equilibrium", *PROJECTIONS), rows)


# ---- windows ---------------------------------------------------------------------------------------------------------


def windows(chapter: Chapter, coarser: int) -> None:
    """What a window that follows saves in `sine`, and what a window that is too small books."""
    scene, _, _ = load_scene("sine")
    scene = replace(scene, cells=replace(scene.cells, count=scene.cells.count // coarser))
    steps = 4000 // coarser
    case = make_case("sine", coarser, steps)
    uniform = Uniform(128, case.bound)
    dxi = 2.0 * case.bound / 128
    rows, runs = [], {}
    for word, velocity in (("uniform", uniform), ("window", Window(dxi))):
        runs[word] = simulate(case.scene, Kinetic(1, velocity), case.clock, 50)
        run = runs[word]
        reaches = (np.abs(run.u) + np.sqrt(2.0 * scene.beta * run.h)).max(axis=1)
        counts = [velocity.grid(float(reach)).count for reach in reaches]
        rows.append([word, min(counts), float(np.mean(counts)), max(counts)])
    chapter.table(f"Velocity nodes along sine, t = 0 ... 4, cells of {dxi:.4f}", ("", "least", "mean", "most"), rows)
    apart = float(np.abs(runs["window"].h - runs["uniform"].h).max())
    chapter.claim("window: the same heights as the fixed grid with the same cells", apart, high=1e-12)
    chapter.claim("window: mean number of nodes over that of the fixed grid", rows[1][2] / 128, high=1.0)
    small = replace(uniform, bound=0.5 * case.bound, beyond="warn")
    cut = simulate(case.scene, Kinetic(1, small), case.clock, 50)
    lost = float(cut.entries["window_loss"][-1])
    chapter.claim("half the window, 'warn': mass of f that the ledger books as lost over the edge", lost, low=1e-6)
    chapter.claim("half the window, 'warn': mass of the state that is not booked", unbooked_drift(cut), high=1e-12)
    stopped = simulate(case.scene, Kinetic(1, replace(small, beyond="stop")), case.clock, 50)
    print("half the window, 'stop':", stopped.verdict)
    chapter.claim("half the window, 'stop': the run ends before its last step", stopped.steps, low=1, high=steps - 1)


# ---- the moment ledger -----------------------------------------------------------------------------------------------


def ledger(chapter: Chapter, coarser: int) -> dict[str, Any]:
    """What each stage did in silo, scheme 1 and 3, for each equilibrium and each force."""
    kept: dict[str, Any] = {}
    gap = 0.0
    for scheme in (1, 3):
        case = make_case("silo", coarser, 1000 // coarser, scheme)
        methods = {name: {"equilibrium": name} for name in EQUILIBRIA}
        methods |= {name: {"force": name} for name in FORCES if name != "shift-linear"}
        for quantity in ("momentum", "energy", "entropy"):
            rows = []
            for name, rooms in methods.items():
                if (name, scheme) not in kept:
                    method = Kinetic(scheme, Uniform(64, 1.1 * case.bound), **rooms)
                    causes = simulate(case.scene, method, case.clock, case.clock.steps, causes=True).causes
                    kept[name, scheme] = causes.isel(t=-1)
                    size = float(np.abs(causes["sum"].values[-1]).sum())
                    gap = max(gap, float(np.abs(causes["sum"].sum("stage") - causes["total"]).max()) / size)
                row = kept[name, scheme].sel(quantity=quantity)
                rows.append([name, *(float(row["sum"].sel(stage=s)) for s in STAGES), float(row["total"])])
            chapter.table(f"{quantity}: change by each stage, silo, scheme {scheme}, {case.scene.cells.count} cells, "
                          f"{case.clock.steps} steps, 64 nodes", ("", *STAGES, "all"), rows)  # fmt: skip
    chapter.claim("ledger: the causes add up to the change of the state, over their size", gap, high=1e-12)
    mass = max(abs(float(entry["sum"].sel(quantity="mass", stage="sampling"))) for (name, _), entry in kept.items()
               if name != "sampled")  # fmt: skip
    rounding = 64 * EPS * case.clock.steps * float(case.twin.entries["mass"][0])
    chapter.claim("ledger: mass made by sampling, all equilibria but 'sampled', is rounding", mass, high=rounding)
    made = abs(float(kept["sampled", 1]["sum"].sel(quantity="mass", stage="sampling")))
    chapter.claim("ledger: mass made by sampling, 'sampled', given back by the projection", made, low=1e-3)
    return kept


def draw_ledger(kept: dict[str, Any]) -> Figure:
    """Bars of the summed change of energy and entropy by stage."""
    figure = Figure(figsize=(11, 4.6), layout="constrained")
    figure.suptitle("silo, scheme 3, 64 nodes, up to t = 1: what each stage did, summed over all steps")
    for axes, quantity in zip(figure.subplots(1, 2), ("energy", "entropy"), strict=True):
        shown = [("cell-average", 0), ("matched", 2), ("entropic", 3)]
        stages = [s for s in STAGES if s not in ("window", "boundary")]
        for number, (name, colour) in enumerate(shown):
            values = kept[name, 3]["sum"].sel(quantity=quantity)
            places = np.arange(len(stages) + 1) + 0.27 * (number - 1)
            heights = [
                *(float(values.sel(stage=s)) for s in stages),
                float(kept[name, 3]["total"].sel(quantity=quantity)),
            ]
            axes.bar(places, heights, width=0.25, color=COLOURS[colour], label=name)
        axes.axhline(0, color="0.4", linewidth=0.8)
        axes.set_xticks(range(len(stages) + 1), [*stages, "all"])
        axes.set_title(quantity, loc="left", fontsize=10)
        axes.grid(axis="y", alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(fontsize=9, frameon=False)
    return figure


if __name__ == "__main__":
    run(main, __doc__)
