"""Scheme 4 carried by a density: positive, conservative and at rest on few nodes, as accurate as its nodes.

With 32 velocity nodes a mass that breaks on dry ground keeps its mass, and f is nowhere negative, if the discrete M
sums to h; `sampled`, which does not, lets cells send more than they have, and h is cut at 0. Piles at rest are
kept bitwise, whatever the discrete M errs in its moments, since faces at rest take their flux literally. How far the
kinetic wing is from the closed form falls with the number of nodes.

What static friction holds back is a part of the density: of the particles that look at a face, M(h) less M(h - theta
e), a shell of the semicircle. The picture shows it in a pile that stands, where it is all of the way uphill, and in a
column that has begun to break, where only the middle is slow enough to be held.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from claims import Chapter, run
from laboratory.family import distance, family
from laboratory.orders import order
from laboratory.pictures import COLOURS
from laboratory.repaired import DELTA, Array, pile, steps
from matplotlib.figure import Figure

from kinsim import (
    Cells,
    Coulomb,
    Courant,
    Dump,
    Fitted,
    Fixed,
    Kinetic,
    Macroscopic,
    Profile,
    Run,
    Scene,
    Uniform,
    load_scene,
    simulate,
)
from kinsim.kinetic.equilibrium import EQUILIBRIA


def main(chapter: Chapter) -> None:
    """Few nodes, rest, many nodes, what is held."""
    few(chapter)
    resting(chapter)
    nodes(chapter, (16, 32, 64, 128, 256) if chapter.full else (16, 32, 64))
    collapse, standing = held(chapter)
    chapter.figure(
        draw(collapse, standing),
        "held",
        "The density, and what static friction holds back of it: left in a pile "
        "that stands, right in a column that breaks. The lower row is one cell of each.",
    )


def column(cells: int = 160, layer: float = 0.0) -> Scene:
    """The silo of the paper on dry ground, or on a layer."""
    silo = load_scene("silo")[0]
    silo = replace(silo, cells=Cells(-4, 4, cells), boundary="wall", title="breaking column")
    return replace(silo, heap=Profile(np.where(np.abs(silo.x) < 1, 2.3, layer)))


def few(chapter: Chapter) -> None:
    """32 nodes on dry ground, all equilibria, first and second order."""
    rows = []
    scene = column(60)
    for name in EQUILIBRIA:
        for order_ in (1, 2):
            method = Kinetic(4, Uniform(32), name, order=order_)
            one = simulate(scene, method, Courant(0.9, 1.5), 10)
            mass = abs(one.entries["mass"][-1] / one.entries["mass"][0] - 1)
            rows.append([name, order_, mass, float(one.h.min()), float(one.entries["f_min"].min())])
            what = f"column on dry ground, 32 nodes, {name}, order {order_}"
            if name == "sampled":  # sums to another mass than h, so that a cell can send more than it has
                chapter.claim(f"{what}: relative change of mass", mass, high=1e-3)
                continue
            chapter.claim(f"{what}: relative change of mass", mass, high=1e-14)
            chapter.claim(f"{what}: least h and f of all steps", min(rows[-1][3:]), low=0.0)
    chapter.table("A column on dry ground with 32 velocity nodes, t = 1.5", (
        "equilibrium", "order", "change of mass", "least h", "least f"), rows)  # fmt: skip


def resting(chapter: Chapter) -> None:
    """Random piles at 100 percent of the bound, 32 nodes: largest change of h and q."""
    rows = []
    for name in EQUILIBRIA:
        row: list[str | float] = [name]
        for zeta in (DELTA / 2, 2 * DELTA):
            for low in (0.0, 0.3):
                scene, worst = pile(zeta, 1, low), 0.0
                h, q = scene.initial()
                method = Kinetic(4, Uniform(32, 4.0), name)
                for h1, q1, _ in steps(scene, method, h, q, 300 if chapter.full else 60, 0.9):
                    worst = max(worst, float(np.abs(h1 - h).max() + np.abs(q1).max()))
                row.append(worst)
        rows.append(row)
        chapter.claim(f"piles at rest, 32 nodes, {name}: change of h and q", max(row[1:]), high=0.0)
    chapter.table("Piles at 100 percent of the bound, 32 nodes: change of h and q", (
        "equilibrium", "delta/2, dry toe", "delta/2, wet", "2 delta, dry toe", "2 delta, wet"), rows)  # fmt: skip


def nodes(chapter: Chapter, counts: tuple[int, ...]) -> None:
    """L1(h) to the closed form at t = 1.5, over the number of nodes.

    In second order a cell at the edge of dry ground may show particles faster than any that it has; these are not
    sent, however many nodes there are. There the two are compared by their errors.
    """
    rows = []
    for order_ in (1, 2):
        scene = column(64, 0.0 if order_ == 1 else 0.3)
        (twin,) = family(scene, Macroscopic(4, order=order_), Courant(0.8, 1.5))
        for name in ("cell-average", "matched"):
            grids = [Kinetic(4, Uniform(n), name, order=order_) for n in counts]
            off = [distance(one, twin, scene) for one in family(scene, grids, twin.replay, force=True)]
            rows.append([f"{name}, order {order_}", *off])
            chapter.claim(f"{name}, order {order_}: order in the number of nodes of L1(h) to the closed form",
                          -order(counts, off), low=1.5)  # fmt: skip
        few = [Kinetic(4, Fitted(n), order=order_) for n in (2, 4, 6, 8)]
        off = [distance(one, twin, scene) for one in family(scene, few, twin.replay, force=True)]
        chapter.table(
            f"L1(h) to the closed form, fitted nodes, order {order_}", [f"{n} nodes" for n in (2, 4, 6, 8)], [off]
        )
        chapter.claim(f"fitted, 8 nodes, order {order_}: L1(h) to the closed form", off[-1], high=1e-12)
    chapter.table(
        "L1(h) to the closed form at t = 1.5, column on dry ground, in second order on a layer of 0.3",
        ("", *(f"{n} nodes" for n in counts)),
        rows,
    )
    scene = column(128)
    fine = simulate(column(2048), Macroscopic(4, order=2), Courant(0.8, 1.5)).h[-1].reshape(128, -1).mean(axis=1)
    ends = [simulate(scene, of, Courant(0.8, 1.5)).h[-1] for of in (Macroscopic(4, order=2), Kinetic(4, order=2))]
    closed, summed = (float(np.abs(h - fine).sum() * scene.cells.dx) for h in ends)
    chapter.claim("column on dry ground, order 2: error of 128 nodes over that of the closed form", summed / closed,
                  low=0.9, high=1.1)  # fmt: skip


def held(chapter: Chapter) -> tuple[Run, Run]:
    """A column that breaks and a pile that stands, with what is held."""
    both = [Dump("M", "equilibrium", 10**6), Dump("back", "held", 10**6)]
    method = Kinetic(4, Uniform(128), "matched")
    collapse = simulate(column(80), method, Courant(0.5, 3.2), 20, dumps=both)
    heap = np.maximum(0.6 - 0.9 * np.abs(np.arange(-19.5, 20) * 0.05) * np.tan(DELTA) / 0.4, 0.0)
    stands = Scene(Cells(-1, 1, 40), Profile(heap), friction=Coulomb(DELTA), boundary="wall", epsilon=0.4,
                   title="pile that stands")  # fmt: skip
    standing = simulate(stands, method, Fixed(1e-3, 20), 20, dumps=both)
    for name, one in (("collapse", collapse), ("pile", standing)):
        M, back = one.dumps["M"][-1].to_numpy(), one.dumps["back"][-1].to_numpy()
        mass = float(back.sum() * (one.dumps["M"]["xi"][1] - one.dumps["M"]["xi"][0]) * one.scene.cells.dx)
        chapter.claim(
            f"{name}: least of what is held, and of M less what is held", min(back.min(), (M - back).min()), low=0.0
        )
        chapter.claim(f"{name}: sum of what is held over the column `held` of the ledger, less 1",
                      abs(mass / one.entries["held"][-1] - 1), high=0.02)  # fmt: skip
    return collapse, standing


def draw(collapse: Run, standing: Run) -> Figure:
    """Above (x, xi) with M in grey and the held part in colour, below one cell."""
    figure = Figure(figsize=(12, 8), layout="constrained")
    panels = figure.subplots(2, 2, height_ratios=(1.2, 1))
    for column_, (one, cell, window) in enumerate(((standing, 12, None), (collapse, None, None))):
        M, back = one.dumps["M"][-1], one.dumps["back"][-1]
        x, xi = M["x"].to_numpy(), M["xi"].to_numpy()
        if cell is None:  # where most is held among the particles to the left
            cell = int(back.to_numpy()[:, : xi.size // 2].sum(axis=1).argmax())
        above, below = panels[:, column_]
        image = above.pcolormesh(x, xi, np.where(back > 0, back, np.nan).T, cmap="cividis_r", rasterized=True)
        k = int(np.argmin(np.abs(one.t - float(M["t"]))))
        c = np.sqrt(2 * one.scene.beta * one.h[k])
        for edge in (one.u[k] - c, one.u[k] + c):
            above.plot(one.x, np.where(one.h[k] > 0, edge, np.nan), color="black", linewidth=1.2)
        figure.colorbar(image, ax=above, label="held part of f", pad=0.01)
        above.axvline(x[cell], color=COLOURS[1], linestyle="--", linewidth=1.2)
        top = float(np.max(np.abs(one.u[k]) + c))
        above.set(
            title=f"{one.scene.title}, t = {float(M['t']):.2f}; black: u ± c",
            xlabel="x (dimensionless)",
            ylabel="particle velocity ξ",
            ylim=(-1.1 * top, 1.1 * top),
            xlim=window or (x[0], x[-1]),
        )
        shell(below, xi, M[cell].to_numpy(), back[cell].to_numpy())
        below.set(
            title=f"cell at x = {x[cell]:.2f} (dashed above)",
            xlabel="particle velocity ξ",
            ylabel="density",
            xlim=(-1.1 * top, 1.1 * top),
        )
    panels[1, 0].legend(frameon=False, loc="upper left", fontsize=9)
    return figure


def shell(axes: object, xi: Array, M: Array, back: Array) -> None:
    """One cell: M, what moves on, what is held."""
    edges = np.append(xi, 2 * xi[-1] - xi[-2]) - 0.5 * (xi[1] - xi[0])
    axes.stairs(M, edges, baseline=M - back, fill=True, color=COLOURS[0], alpha=0.9, label="held back")
    axes.stairs(M - back, edges, fill=True, color="0.85", label="goes on")
    axes.stairs(M, edges, color="black", linewidth=1.2, label="M")
    axes.axvline(0, color="0.5", linewidth=0.8)
    axes.spines[["top", "right"]].set_visible(False)


if __name__ == "__main__":
    run(main, __doc__)
