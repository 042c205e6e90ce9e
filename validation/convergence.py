"""How fast the schemes converge, in dx, in dt, in dxi, and in all together.

Judges are exact solutions that come from no scheme: waves in the accelerated frame, a wedge, a cap, a dam that breaks
over dry ground. A first-order upwind scheme converges like dx where the solution is smooth, and not slower than the
square root of dx where it has jumps, corners or dry fronts. The velocity grid is judged by the closed-form twin, whose
velocity error is zero; there the error falls like the square of dxi.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from claims import Chapter, run
from laboratory.judged import error, scene_of
from matplotlib.figure import Figure

from kinsim import Cells, Courant, Fixed, Kinetic, Macroscopic, Uniform, load_scene, simulate
from kinsim.exact import AcceleratedRiemann, ParabolicCap, Riemann, SlidingWedge, TravellingShock

BETA = 0.4
DOWN, UP = {"pull": 0.4, "resistance": 0.3}, {"pull": 0.3, "resistance": 0.4}
EVERYWHERE = (-3.0, 7.0)

CASES: dict[str, tuple[Any, float, tuple[float, float], float]] = {
    "wedge": (SlidingWedge(2.0, 0.1, 0.5, BETA, **DOWN), 1.0, (-1.5, 3.5), 0.98),
    "cap": (ParabolicCap(1, 1, BETA, **DOWN, u0=1.5), 1.5, EVERYWHERE, 0.5),
    "fan and shock": (AcceleratedRiemann(Riemann(1, 1.2, 0.4, 1.0, BETA), **DOWN), 2.0, EVERYWHERE, 0.5),
    "shock": (TravellingShock(1, 1.2, 0.5, BETA, **UP), 2.0, EVERYWHERE, 0.5),
    "dam on dry ground": (AcceleratedRiemann(Riemann(1, 0, 0, 0, BETA), **DOWN), 2.0, EVERYWHERE, 0.5),
    "dam without friction": (Riemann(1, 0, 0.5, 0, BETA), 2.0, EVERYWHERE, 0.5),
}
"""Exact solution, end, where it is judged, and the order that theory lets expect at least."""


def main(chapter: Chapter) -> None:
    """dx at several time steps, then dt, dxi, and all together."""
    counts = (140, 280, 560, 1120, 2240) if chapter.full else (140, 280, 560, 1120)
    errors = {clock: in_dx(chapter, clock, counts) for clock in (0.3, 0.6, 0.9, "paper's dt")}
    chapter.figure(picture(errors[0.9], counts), "dx", "L1 error of h against exact solutions, scheme 1, Courant 0.9")
    in_dt(chapter)
    in_dxi(chapter)
    whole_runs(chapter)
    jointly(chapter)


def in_dx(chapter: Chapter, clock: float | str, counts: tuple[int, ...]) -> dict[str, list[float]]:
    """Halve dx at a fixed Courant number, or at the paper's dt = 0.001."""
    found, rows = {}, []
    for name, (exact, end, inner, order) in CASES.items():
        errors = []
        for count in counts:
            timing = Courant(clock, end) if isinstance(clock, float) else Fixed(1e-3, round(end / 1e-3))
            done = simulate(scene_of(exact, Cells(-5, 9, count), BETA), Macroscopic(1), timing, 10**6)
            errors.append(error(exact, done, inner))
        orders = [math.log2(coarse / fine) for coarse, fine in pairwise(errors)]
        rows.append([name, *errors, *(f"{each:.2f}" for each in orders)])
        courant = isinstance(clock, float)  # at a fixed dt the error of dt stays behind: judge where that of dx leads
        first, last = (errors[-3], errors[-1]) if courant else (errors[0], errors[2])
        low = order if courant else order - 0.1
        chapter.claim(f"order in dx, {name}, {_words(clock)}", math.log(first / last, 4), low=low)
        found[name] = errors
    heads = ["exact solution", *(f"dx = {14 / count:.4g}" for count in counts), *["order"] * (len(counts) - 1)]
    chapter.table(f"L1(h), scheme 1, {_words(clock)}", heads, rows)
    return found


def in_dt(chapter: Chapter) -> None:
    """Halve dt at a fixed dx: what is left is the error of the source, of first order."""
    exact, end, inner, _ = CASES["wedge"]
    scene = scene_of(exact, Cells(-5, 9, 140), BETA)
    steps = (25, 50, 100, 200)
    fine = simulate(scene, Macroscopic(1), Fixed(end / 3200, 3200), 10**6)
    apart = []
    for count in steps:
        done = simulate(scene, Macroscopic(1), Fixed(end / count, count), 10**6)
        keep = (done.x > inner[0]) & (done.x < inner[1])
        apart.append(float(np.abs(done.h[-1] - fine.h[-1])[keep].sum() * scene.cells.dx))
    orders = [math.log2(a / b) for a, b in pairwise(apart)]
    chapter.table("L1(h) to dt -> 0, wedge, dx = 0.1", [f"dt = {end / n:g}" for n in steps], [apart])
    chapter.claim("order in dt, wedge, dx fixed", orders[0], low=0.9, high=1.1)


def in_dxi(chapter: Chapter) -> None:
    """Halve dxi at fixed dx and dt: the difference to the closed-form twin."""
    nodes = (16, 32, 64, 128)
    rows = []
    for name in ("cap", "fan and shock", "dam on dry ground"):
        exact, end, _, _ = CASES[name]
        scene, clock = scene_of(exact, Cells(-5, 9, 140), BETA), Fixed(end / 100, 100)
        twin = simulate(scene, Macroscopic(1), clock, 10**6)
        apart = [
            float(np.abs(simulate(scene, Kinetic(1, Uniform(n)), clock, 10**6).h[-1] - twin.h[-1]).sum() * 0.1)
            for n in nodes
        ]
        orders = [math.log2(a / b) for a, b in pairwise(apart)]
        rows.append([name, *apart, *(f"{each:.2f}" for each in orders)])
        chapter.claim(f"order in dxi, {name}", math.log(apart[0] / apart[-1], nodes[-1] / nodes[0]), low=1.8)
    heads = ["exact solution", *(f"{n} nodes" for n in nodes), *["order"] * (len(nodes) - 1)]
    chapter.table("L1(h) to the closed-form twin, cell averages, dx = 0.1", heads, rows)


def whole_runs(chapter: Chapter) -> None:
    """The five scenes of the paper, kinetic against twin, tabulated as found.

    Scheme 1 where a mass should stop, and scheme 3 in `sine`, amplify any rounding (see the chapter on the zigzag), so
    that no order can show below that floor; claims are made where there is none.
    """
    rows = []
    for scheme, equilibrium in ((1, "cell-average"), (3, "cell-average"), (1, "sampled"), (3, "sampled")):
        for name in ("riemann", "silo", "silo-incline", "parabola", "sine"):
            scene, _, clock = load_scene(name)
            clock = clock if chapter.full else replace(clock, steps=500)
            twin = simulate(scene, Macroscopic(scheme), clock, 10**6)
            apart = [
                float(
                    np.abs(
                        simulate(scene, Kinetic(scheme, Uniform(n), equilibrium), clock, 10**6).h[-1] - twin.h[-1]
                    ).sum()
                )
                * scene.cells.dx
                for n in (64, 128, 256)
            ]
            mean = math.log(apart[0] / apart[-1], 4)
            rows.append([name, scheme, equilibrium, *apart, f"{mean:.2f}"])
            floor = (scheme == 1 and name in ("silo", "silo-incline", "parabola")) or (scheme == 3 and name == "sine")
            if equilibrium == "cell-average" and not floor:
                chapter.claim(f"whole run, scheme {scheme}, {name}: order of L1(h) in dxi", mean, low=1.8)
    heads = ["scene", "scheme", "equilibrium", "64 nodes", "128", "256", "order"]
    chapter.table("L1(h) to the twin at the end of the run", heads, rows)


def jointly(chapter: Chapter) -> None:
    """Halve dx, dt and dxi together, the density carried: the order of dx, which dominates."""
    rows = []
    for name in ("wedge", "fan and shock"):
        exact, end, inner, order = CASES[name]
        errors = []
        for level in (1, 2, 4):
            scene = scene_of(exact, Cells(-5, 9, 70 * level), BETA)
            errors.append(error(exact, simulate(scene, Kinetic(1, Uniform(24 * level)), Courant(0.6, end)), inner))
        rows.append([name, *errors])
        chapter.claim(f"order in dx, dt and dxi together, {name}", math.log(errors[0] / errors[-1], 4), low=order - 0.1)
    chapter.table("L1(h), kinetic, 24 nodes at dx = 0.2", ["exact solution", "dx = 0.2", "dx = 0.1", "dx = 0.05"], rows)


def picture(errors: dict[str, list[float]], counts: tuple[int, ...]) -> Figure:
    """Errors over dx, each line with its name at its end."""
    figure = Figure(figsize=(7.5, 5), layout="constrained")
    axes = figure.subplots()
    dx = 14 / np.array(counts)
    colours = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#000000")
    for (name, each), colour, marker in zip(errors.items(), colours, "os^vDP", strict=True):
        axes.loglog(dx, each, color=colour, marker=marker, label=name)
    for power, style in ((1.0, ":"), (0.5, "--")):
        axes.loglog(dx, 0.6 * dx**power, color="0.6", linestyle=style, label=f"order {power:g}")
    axes.set_xticks(dx, [f"{each:.3g}" for each in dx], minor=False)
    axes.set_xticks([], minor=True)
    axes.set_xlabel("dx (dimensionless)")
    axes.set_ylabel("L1 error of h")
    axes.legend(frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.grid(alpha=0.3)
    return figure


def _words(clock: float | str) -> str:
    return f"Courant {clock}" if isinstance(clock, float) else clock


if __name__ == "__main__":
    run(main, __doc__)
