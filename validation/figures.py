"""Figures 1 to 6: the five tests of section 4, the kinetic wing and its closed-form twin side by side.

Scheme 3 with the paper's cells and steps, and, on the kinetic side, a density on a velocity grid. What the text of
section 4 promises is claimed with numbers:

1. the Riemann problem meets its exact solution, better on finer cells: L1(h) is 0.090, 0.053 and 0.030, within 5
   percent, for dx = 0.05, 0.025 and 0.0125. Against exact values at the cell centres these are 0.0901, 0.0532 and
   0.0301; against exact cell averages, which is what a cell holds, 0.0870, 0.0505 and 0.0298;
2. and 3. the silo spreads symmetrically and comes to rest, on a slope that friction can hold;
4. on the incline it moves to the right and comes to rest;
5. the parabola spreads symmetrically and comes to rest;
6. the sine splits into two humps that accelerate at sin zeta - R.

Each picture has profiles at the paper's times with the difference of the wings below, and h(x, t) of both wings in
three dimensions. Wings are compared with what the run moved, the integral of |h(end) - h(start)|.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from claims import Chapter, run
from laboratory.pictures import COLOURS
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D

from kinsim import Fixed, Kinetic, Macroscopic, Run, Uniform, load_scene, simulate
from kinsim.exact import Riemann, coulomb_fill


@dataclass(frozen=True)
class Shown:
    """How a scene is drawn: which figure, steps of the profiles, the part of the x-axis, and from where it is seen."""

    number: str
    steps: tuple[int, ...]
    x: tuple[float, float]
    view: tuple[float, float]


SCENES = {
    "riemann": Shown("Figure 1", (0, 5000), (-6, 6), (32, -65)),
    "silo": Shown("Figures 2 and 3", (0, 1100, 10000), (-8, 8), (32, -65)),
    "silo-incline": Shown("Figure 4", (0, 1100, 8000), (-8, 8), (32, -65)),
    "parabola": Shown("Figure 5", (0, 1100, 6000), (-4, 4), (32, -65)),
    "sine": Shown("Figure 6", (0, 2000, 4000), (-3, 11), (38, -65)),
}


def main(chapter: Chapter) -> None:
    """Run each scene twice, claim what the paper says, draw."""
    nodes, rows = (256 if chapter.full else 64), []
    for name, shown in SCENES.items():
        scene, _, clock = load_scene(name)
        every = 100
        closed = simulate(scene, Macroscopic(3), clock, every)
        kinetic = simulate(scene, Kinetic(3, Uniform(nodes)), clock, every)
        for wing, one in (("closed form", closed), ("kinetic", kinetic)):
            JUDGES[name](chapter, f"{name}, {wing}", one)
        moved = float(np.abs(closed.h[-1] - closed.h[0]).sum())
        apart = float(np.abs(kinetic.h[-1] - closed.h[-1]).sum())
        chapter.claim(
            f"{name}: difference of the wings, {nodes} nodes, over what moved, L1(h)", apart / moved, high=2e-3
        )
        rows.append([name, clock.steps, apart * scene.cells.dx, moved * scene.cells.dx, str(closed.verdict.kind)])
        chapter.figure(draw(name, shown, kinetic, closed), name, f"{shown.number} of the paper: {scene.title}.")
    chapter.table(f"Wings at the end, {nodes} velocity nodes", ("scene", "steps", "L1(h) apart", "moved", "end"), rows)
    finer_riemann(chapter)


def judge_riemann(chapter: Chapter, who: str, one: Run) -> None:
    """L1(h) at t = 5, within 5 percent of 0.090, and scheme 3 leaves no zigzag."""
    for what, found in (("exact cell averages", error(one)), ("exact values at cell centres", error_at_centres(one))):
        chapter.claim(f"{who}: L1(h) to {what} at t = 5, dx = 0.05", found, low=0.0855, high=0.0945)
    zigzag = np.abs(one.h[-1, 1:-1] - 0.5 * (one.h[-1, 2:] + one.h[-1, :-2]))[np.abs(one.x[1:-1] - 0.8) < 0.8].max()
    chapter.claim(f"{who}: largest h less mean of its neighbours on the plateau", zigzag, high=1e-3)


def judge_rest(chapter: Chapter, who: str, one: Run) -> None:
    """At rest, on a slope that friction holds."""
    scene = one.scene
    chapter.claim(f"{who}: comes to rest, largest |q| at the end", np.abs(one.q[-1]).max(), high=_rest(one))
    fill = coulomb_fill(one.h[-1], scene.cells.dx, pull=scene.chute.sin, resistance=scene.resistance, beta=scene.beta,
                        per="cell")  # fmt: skip
    chapter.claim(f"{who}: slope at the end over what friction holds, (22)", fill, high=1.001)


def judge_symmetric(chapter: Chapter, who: str, one: Run) -> None:
    """Symmetric all the time, and at rest."""
    uneven = max(np.abs(one.h - one.h[:, ::-1]).max(), np.abs(one.q + one.q[:, ::-1]).max())
    chapter.claim(f"{who}: departure from symmetry, h and q, all times", uneven, high=1e-13)
    judge_rest(chapter, who, one)


def judge_incline(chapter: Chapter, who: str, one: Run) -> None:
    """The mass moves to the right, and comes to rest."""
    above = one.h - 0.3
    centre = (above * one.x).sum(axis=1) / above.sum(axis=1)
    chapter.claim(f"{who}: way of the centre of mass to the right, in cells", np.ptp(centre[[0, -1]]) / 0.05
                  * np.sign(centre[-1] - centre[0]), low=1.0)  # fmt: skip
    judge_rest(chapter, who, one)


def judge_sine(chapter: Chapter, who: str, one: Run) -> None:
    """Two humps, and the mean velocity gains sin zeta - R per time."""
    h = one.h[-1]
    tops = [i for i in range(6, len(h) - 6) if h[i] > 0.12 and h[i] == h[i - 6 : i + 7].max()]
    chapter.claim(f"{who}: humps at the end", len(tops), low=2, high=2)
    mean = one.q.sum(axis=1) / one.h.sum(axis=1)
    gain = np.polyfit(one.t, mean, 1)[0] / (one.scene.chute.sin - one.scene.resistance)
    chapter.claim(f"{who}: acceleration over sin zeta - R", gain, low=0.97, high=1.03)


JUDGES = {
    "riemann": judge_riemann, "silo": judge_symmetric, "silo-incline": judge_incline, "parabola": judge_symmetric,
    "sine": judge_sine,
}  # fmt: skip


def _rest(one: Run) -> float:
    """Rest in closed form is rounding; on a grid of cell averages a share of a velocity cell."""
    velocity = getattr(one.method, "velocity", None)
    return 1e-12 if velocity is None else 2e-3 * velocity.bound / velocity.count * float(one.h.max())


def finer_riemann(chapter: Chapter) -> None:
    """Finer cells with the paper's dt, closed form, against exact cell averages and against values at cell centres.

    They differ by what the cell of the shock counts: a cell's height is an average, to which the exact average in that
    cell is nearer than the exact value at its centre.
    """
    scene, _, _ = load_scene("riemann")
    for count, expected in ((480, 0.053), (960, 0.030)):
        one = simulate(replace(scene, cells=replace(scene.cells, count=count)), Macroscopic(3), Fixed(1e-3, 5000), 5000)
        for what, found in (
            ("exact cell averages", error(one)),
            ("exact values at cell centres", error_at_centres(one)),
        ):
            chapter.claim(f"riemann, closed form: L1(h) to {what} at t = 5, dx = {12 / count:g}", found,
                          low=0.95 * expected, high=1.05 * expected)  # fmt: skip


def error(one: Run) -> float:
    """L1(h) to the exact cell averages at the end."""
    exact, _ = Riemann(1.0, 0.0, 0.5, 0.0, one.scene.beta).averages(one.scene.cells, float(one.t[-1]))
    return float(np.abs(one.h[-1] - exact).sum() * one.scene.cells.dx)


def error_at_centres(one: Run) -> float:
    """L1(h) to the exact values at the cell centres at the end."""
    exact, _ = Riemann(1.0, 0.0, 0.5, 0.0, one.scene.beta)(one.x, float(one.t[-1]))
    return float(np.abs(one.h[-1] - exact).sum() * one.scene.cells.dx)


def draw(name: str, shown: Shown, kinetic: Run, closed: Run) -> Figure:
    """Profiles and the wings' difference, and two views of h(x, t)."""
    figure = Figure(figsize=(14.5, 5.2), layout="constrained")
    figure.suptitle(f"{shown.number}: {kinetic.scene.title} (all quantities dimensionless)")
    grid = figure.add_gridspec(2, 3, height_ratios=(2.2, 1), width_ratios=(1.25, 1, 1))
    upper, lower = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[1, 0])
    profiles(upper, lower, shown, kinetic, closed, name == "riemann")
    for column, (wing, one) in enumerate((("kinetic", kinetic), ("closed form", closed)), start=1):
        surface(figure.add_subplot(grid[:, column], projection="3d"), wing, one, shown)
    return figure


def profiles(upper: Axes, lower: Axes, shown: Shown, kinetic: Run, closed: Run, exact: bool) -> None:
    """h at the paper's times, kinetic as a line and closed form as dots; below how far they are apart."""
    if exact:
        fine = np.linspace(*shown.x, 4001)
        upper.plot(fine, Riemann(1.0, 0.0, 0.5, 0.0, closed.scene.beta)(fine, 5.0)[0], color="black", linewidth=1,
                   label="exact, t = 5")  # fmt: skip
    for number, steps in enumerate(shown.steps):
        row = int(np.argmin(np.abs(kinetic.t - steps * 1e-3)))
        t, colour = f"t = {kinetic.t[row]:g}", COLOURS[number]
        upper.plot(kinetic.x, kinetic.h[row], color=colour, linewidth=1.8, linestyle=("-", "--", "-.")[number], label=t)
        upper.plot(closed.x[::5], closed.h[row, ::5], ".", color=colour, markersize=5)
        if steps:
            lower.semilogy(kinetic.x, np.maximum(np.abs(kinetic.h[row] - closed.h[row]), 1e-18), color=colour,
                           linewidth=1.3, linestyle=("-", "--", "-.")[number])  # fmt: skip
    upper.plot([], [], ".", color="0.3", label="closed form")
    upper.set_title("profiles: lines kinetic, dots closed form", loc="left", fontsize=10)
    upper.set(ylabel="height h", xlim=shown.x, ylim=(0, None))
    upper.legend(frameon=False, fontsize=9)
    lower.set(xlabel="x", ylabel="|kinetic -\nclosed form|", xlim=shown.x, ylim=(1e-10, 1e-2))
    for axes in (upper, lower):
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)


def surface(axes: Axes3D, wing: str, one: Run, shown: Shown) -> None:
    """h(x, t) as the paper shows it: one line per time."""
    rows = np.linspace(0, one.t.size - 1, 41).astype(int)
    x, t = np.meshgrid(one.x, one.t[rows])
    axes.plot_surface(x, t, one.h[rows], cmap="cividis", rstride=1, cstride=2, linewidth=0, alpha=0.9, rasterized=True)
    axes.plot_wireframe(x, t, one.h[rows], rstride=2, cstride=0, color="black", linewidth=0.5)
    axes.view_init(*shown.view)
    axes.set_box_aspect((1.5, 1.2, 0.8), zoom=0.92)
    axes.set(xlabel="x", ylabel="t", xlim=shown.x, ylim=(0, one.t[-1]), zlim=(0, one.h.max()))
    axes.set_title(f"{wing}: h(x, t)", fontsize=11)


if __name__ == "__main__":
    run(main, __doc__)
