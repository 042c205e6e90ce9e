"""Two ways not to converge: the zigzag of scheme 2, and the chatter of scheme 1 where mass should stop.

**Zigzag.** F~ takes the mean height at a face. An odd-even mode of h has the same mean everywhere, so that F~ does not
see it: its factor per step is exactly 1. F damps it, by 1 - 4 c lam/pi on a layer at rest (the derivative of I1 by h,
twice per face). So scheme 2 keeps what a jump throws up: about +-0.015 around the plateau of `riemann`; scheme 3 has
none.

**Chatter.** In scheme 1 friction turns the sign of u in each step, u to u - dt R and back, where mass should stop. Any
mean velocity within +- dt R/2 is an equilibrium of that, and roundings decide which: heights moved by 1e-13 end up
1e-4 to 1e-3 apart, L1(h), in closed form, on `silo`, `silo-incline` and `parabola`. No other code, and no velocity
grid, can come closer to the closed form than the closed form comes to itself. Scheme 3 does not do that, except in
`sine`, where cells alternate between its branches.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from claims import Chapter, run
from laboratory.family import distance, family
from laboratory.measures import disturbed, order
from laboratory.pictures import COLOURS, MARKS
from matplotlib.figure import Figure
from numpy.typing import NDArray

from kinsim import Cells, Frictionless, Kinetic, Macroscopic, Profile, Run, Scene, Uniform, load_scene, simulate, step

Array = NDArray[np.float64]
SIZE = 1e-13
STOPPING = ("silo", "silo-incline", "parabola")


def main(chapter: Chapter) -> None:
    """Modes, riemann, chaos, what it means for the kinetic wing."""
    factors = amplification(chapter)
    plateaus = riemann(chapter)
    growth = chaos(chapter)
    converging(chapter, (64, 128, 256) if chapter.full else (32, 64, 128))
    chapter.figure(draw(factors, plateaus), "zigzag", "The odd-even mode: what F and F~ do to it, and `riemann`.")
    chapter.figure(draw_chaos(growth), "chatter", "L1(h) between two closed-form runs whose starts differ by 1e-13.")


def amplification(chapter: Chapter) -> dict[str, tuple[Array, Array]]:
    """Largest factor per step of a wave in h and q on a layer at rest, by wave number."""
    count, dx, tiny = 64, 0.05, 1e-6
    scene = Scene(Cells(0, count * dx, count), Profile(np.ones(count)), friction=Frictionless(), boundary="periodic",
                  epsilon=0.4)  # fmt: skip
    c = np.sqrt(2 * scene.beta)
    dt = 0.5 * dx / c
    waves = np.arange(1, count // 2 + 1)
    found = {}
    for name, scheme in (("F, scheme 1", 1), ("F~, scheme 2", 2)):
        factors = []
        for k in waves:
            wave = np.cos(2 * np.pi * k * np.arange(count) / count)
            matrix = np.zeros((2, 2), dtype=complex)
            for column, (dh, dq) in enumerate(((tiny, 0.0), (0.0, tiny))):
                there, back = (
                    step(scene, Macroscopic(scheme), 1.0 + s * dh * wave, s * dq * wave, dt) for s in (1, -1)
                )
                for row, change in enumerate((there.h1 - back.h1, there.q1 - back.q1)):
                    matrix[row, column] = np.fft.fft(change)[k] / np.fft.fft(2 * tiny * wave)[k]
            factors.append(np.abs(np.linalg.eigvals(matrix)).max())
        found[name] = (2 * np.pi * waves / count, np.array(factors))
    lam_c = dt / dx * c
    zigzag = (-1.0) ** np.arange(count)
    kept = step(scene, Macroscopic(2), 1.0 + 0.1 * zigzag, 0.0 * zigzag, dt).h1
    chapter.claim("F~: change of a zigzag of 0.1 in h in one step", np.abs(kept - (1.0 + 0.1 * zigzag)).max(), high=0.0)
    foreseen = max(abs(1 - 4 * lam_c / np.pi), abs(1 - 16 * lam_c / (3 * np.pi)))
    chapter.claim("F~: factor of the odd-even mode, less 1", abs(found["F~, scheme 2"][1][-1] - 1), high=1e-9)
    chapter.claim("F: factor of the odd-even mode, less max(|1 - 4 lam c/pi|, |1 - 16 lam c/(3 pi)|)",
                  abs(found["F, scheme 1"][1][-1] - foreseen), high=1e-8)  # fmt: skip
    return found


def riemann(chapter: Chapter) -> dict[str, Run]:
    """The zigzag around the plateau."""
    scene, _, clock = load_scene("riemann")
    runs = {f"scheme {n}": simulate(scene, Macroscopic(n), clock, clock.steps) for n in (2, 3)}
    sizes = {}
    for name, one in runs.items():
        h, plateau = one.h[-1], np.abs(one.x[1:-1] - 0.5) < 1.5
        sizes[name] = 0.5 * np.abs(h[1:-1] - 0.5 * (h[2:] + h[:-2]))[plateau].max()
    chapter.claim(
        "riemann, scheme 2: half height of the zigzag around the plateau", sizes["scheme 2"], low=0.012, high=0.018
    )
    chapter.claim("riemann, scheme 3: half height of the zigzag around the plateau", sizes["scheme 3"], high=1e-3)
    return runs


def chaos(chapter: Chapter) -> dict[tuple[str, int], tuple[Array, Array]]:
    """L1(h) over time between a closed-form run and one whose heights differ by 1e-13."""
    found, rows = {}, []
    for name in ("riemann", *STOPPING, "sine"):
        scene, _, clock = load_scene(name)
        row: list[str | float] = [name]
        for scheme in (1, 3):
            one, other = (simulate(s, Macroscopic(scheme), clock, 100) for s in (scene, disturbed(scene, SIZE)))
            apart = np.abs(one.h - other.h).sum(axis=1) * scene.cells.dx
            found[name, scheme] = (one.t, apart)
            row += [float(apart[0]), float(apart[-1])]
            if scheme == 1 and name in STOPPING:
                chapter.claim(
                    f"{name}, scheme 1: L1(h) at the end from 1e-13 at the start", apart[-1], low=1e-5, high=1e-2
                )
            elif name == "sine" and scheme == 3:
                chapter.claim("sine, scheme 3: largest L1(h) from 1e-13 at the start", apart.max(), low=1e-7, high=1e-3)
            else:
                chapter.claim(f"{name}, scheme {scheme}: largest L1(h) over that at the start", apart.max() / apart[0],
                              high=100.0)  # fmt: skip
        rows.append(row)
    chapter.table("L1(h) between closed-form runs whose heights differ by 1e-13", (
        "scene", "scheme 1, start", "end", "scheme 3, start", "end"), rows)  # fmt: skip
    return found


def converging(chapter: Chapter, nodes: tuple[int, ...]) -> None:
    """What that means for whole kinetic runs, on `silo` and `parabola` to t = 2."""
    rows = []
    for name in ("silo", "parabola"):
        scene, _, clock = load_scene(name)
        clock = replace(clock, steps=2000)
        for scheme in (1, 3):
            closed, grids = Macroscopic(scheme), [Kinetic(scheme, Uniform(n)) for n in nodes]
            scenes = [scene, disturbed(scene, SIZE), *[scene] * len(nodes)]
            twin, nudged, *each = family(scenes, [closed, closed, *grids], clock)
            floor, *off = (distance(one, twin, scene) for one in (nudged, *each))
            rows.append([name, scheme, floor, *off])
            if scheme == 1:
                if name == "parabola":
                    chapter.claim(f"{name}, scheme 1, {nodes[-1]} nodes: L1(h) to the closed form over its own chatter",
                                  off[-1] / floor, low=0.3, high=3.0)  # fmt: skip
            else:
                chapter.claim(
                    f"{name}, scheme 3: order in n of L1(h) to the closed form", order(list(nodes), off), low=1.8
                )
    chapter.table("L1(h) to the closed form at t = 2", ("scene", "scheme", "1e-13 at the start",
                  *(f"{n} nodes" for n in nodes)), rows)  # fmt: skip


def draw(factors: dict[str, tuple[Array, Array]], plateaus: dict[str, Run]) -> Figure:
    """Left the factors by wave number, right the plateau."""
    figure = Figure(figsize=(12, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for number, (name, (wave, factor)) in enumerate(factors.items()):
        left.plot(wave / np.pi, factor, color=COLOURS[number], marker=MARKS[number], markersize=4, label=name)
    left.set_title("largest factor per step of a wave, layer at rest, Courant number 0.5", loc="left", fontsize=10)
    left.set(xlabel=r"wave number over $\pi/\Delta x$ (1: odd-even)", ylim=(0, 1.08))
    left.legend(frameon=False, loc="lower left")
    for number, (name, one) in enumerate(reversed(plateaus.items())):
        right.plot(
            one.x, one.h[-1], color=COLOURS[number], linewidth=1.5, marker=MARKS[number], markersize=3, label=name
        )
    right.set_title("riemann at t = 5, around the plateau", loc="left", fontsize=10)
    right.set(xlabel="x (dimensionless)", ylabel="height h", xlim=(-2.5, 3.5), ylim=(0.65, 0.85))
    right.legend(frameon=False, loc="lower left")
    for axes in (left, right):
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def draw_chaos(growth: dict[tuple[str, int], tuple[Array, Array]]) -> Figure:
    """One panel per scheme."""
    figure = Figure(figsize=(12, 4.4), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    names = list(dict.fromkeys(name for name, _ in growth))
    for axes, scheme in zip(panels, (1, 3), strict=True):
        for number, name in enumerate(names):
            t, apart = growth[name, scheme]
            axes.semilogy(t, np.maximum(apart, 1e-16), color=COLOURS[number], marker=MARKS[number], markevery=10,
                          markersize=5, linewidth=1.4, label=name)  # fmt: skip
        axes.set_title(f"scheme {scheme}", loc="left", fontsize=10)
        axes.set(xlabel="t (dimensionless)", ylim=(1e-16, 1e1))
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("L1(h) between the two runs")
    panels[0].legend(frameon=False, ncols=3, loc="upper right", fontsize=9)
    return figure


if __name__ == "__main__":
    run(main, __doc__)
