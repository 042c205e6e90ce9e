"""Convergence of scheme 4 against every exact solution, dry ones included, in first and second order.

Both are judged at Courant numbers 0.5 and 0.9; waves of both families at 1, the limit, too. Where the solution is a
straight line first order converges like dx, and where it has jumps, corners or dry fronts between the square root of
dx and dx; second order is not bound to that, but a jump allows no more than dx, and corners and dry fronts a little
more. On smooth data second order is: a simple wave on a ring, before it breaks; and waves of both families, which have
no exact solution in closed form and are judged by cells halved again and again.

Scheme 4 has no step from wet to dry: the dam on dry ground, with and without friction, the cap, and the vacuum that
opens between two masses are taken like everything else.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from claims import Chapter, run
from laboratory.family import family
from laboratory.judged import BETA, CASES, DOWN, EVERYWHERE, HELD, ROUGH, SMOOTH, Case
from laboratory.orders import Panel, falls, halvings, order, picture
from laboratory.repaired import Array

from kinsim import Cells, Courant, Frictionless, Macroscopic, Profile, Scene
from kinsim.exact import ParabolicCap, Riemann, UniformSlide
from kinsim.solver.solver import Solver

DRY = {
    "Ritter": Case(Riemann(1, 0, 0, 0, BETA), 2.0, wet=False),
    "vacuum": Case(Riemann(0.5, -1.2, 0.5, 1.2, BETA, x0=2.0), 1.5, EVERYWHERE, wet=False),
    "flat cap": Case(ParabolicCap(0.5, 2, BETA, **DOWN, u0=1.0), 1.5, wet=False),
}
"""Beyond those that the printed schemes can be asked about."""

JUDGES = {name: case for name, case in (CASES | DRY).items() if name != "pile"}
SLIDES = {
    "slide": Case(UniformSlide(1.0, **DOWN), 1.5),
    "slide that stops": Case(UniformSlide(0.3, **HELD), 1.5, rests=True),
    "pile": CASES["pile"],
}

METHODS = {
    "first order, Courant 0.5": (Macroscopic(4), 0.5),
    "first order, Courant 0.9": (Macroscopic(4), 0.9),
    "second order, Courant 0.5": (Macroscopic(4, order=2), 0.5),
    "second order, Courant 0.9": (Macroscopic(4, order=2), 0.9),
}
FIRST, SECOND = "first order, Courant 0.5", "second order, Courant 0.9"
STRAIGHT = ("wedge", "steep wedge", "wedge that stops")
HALVED = ("cap", "flat cap", "dam without friction", "dam on a wet bed", "fan and shock", "shock", "dam on dry ground",
          "Ritter")  # fmt: skip
"""Waves and caps, on which second order leaves a third of the error or less."""


@dataclass(frozen=True)
class SimpleWave:
    """A wave that runs to the right on a ring of length 1 without friction, exact until it breaks.

    Where h = 1 + a sin 2 pi y and u = 2 (sqrt(beta h) - sqrt(beta)) at the start, (h, u) travels at u + sqrt(beta h):
    u - 2 sqrt(beta h) is the same everywhere, so that only one family of characteristics carries anything.
    """

    a: float = 0.2

    def start(self, y: Array) -> tuple[Array, Array]:
        """h, u at t = 0."""
        h = 1.0 + self.a * np.sin(2 * np.pi * y)
        return h, 2.0 * (np.sqrt(BETA * h) - math.sqrt(BETA))

    @property
    def breaks(self) -> float:
        """When the first characteristics meet: 1/max(-d/dy (u + sqrt(beta h)))."""
        y = np.linspace(0, 1, 100_001)
        h, _ = self.start(y)
        steepness = 1.5 * math.sqrt(BETA) / np.sqrt(h) * self.a * 2 * np.pi * np.cos(2 * np.pi * y)
        return float(1.0 / -steepness.min())

    def averages(self, cells: Cells, t: float) -> Array:
        """Averages of h over the cells at time t, from y(x) by Newton at five Gauss points of each cell."""
        nodes, weights = np.polynomial.legendre.leggauss(5)
        x = cells.x[:, None] + 0.5 * cells.dx * nodes
        y = x - math.sqrt(BETA) * t
        for _ in range(60):
            h, u = self.start(y)
            rate = 1.5 * np.sqrt(BETA / h) * self.a * 2 * np.pi * np.cos(2 * np.pi * y)
            y -= (y + (u + np.sqrt(BETA * h)) * t - x) / (1.0 + rate * t)
        averages: Array = 0.5 * self.start(y)[0] @ weights
        return averages

    def errors(self, method: Macroscopic, number: float, counts: Sequence[int], end: float) -> list[float]:
        """L1(h) at time `end` on each number of cells."""
        nodes, weights = np.polynomial.legendre.leggauss(5)
        scenes = []
        for count in counts:
            cells = Cells(0.0, 1.0, count)
            h, u = self.start(cells.x[:, None] + 0.5 * cells.dx * nodes)
            mean = 0.5 * h @ weights
            scenes.append(Scene(cells, Profile(mean, 0.5 * (h * u) @ weights / mean), friction=Frictionless(),
                                boundary="periodic", epsilon=BETA))  # fmt: skip
        return [
            float(np.abs(run.arrays["h"] - self.averages(scene.cells, end)).sum() * scene.cells.dx)
            for scene, run in zip(scenes, family(scenes, method, Courant(number, end)), strict=True)
        ]


def main(chapter: Chapter) -> None:
    """Orders against exact solutions, smooth data, what is met to rounding, first against second order."""
    counts = halvings(140, 4 if chapter.full else 3)
    found = {name: converge(chapter, name, counts) for name in METHODS}
    wave = smooth(chapter, halvings(20, 6 if chapter.full else 4))
    crossing(chapter, halvings(40, 6 if chapter.full else 4))
    compared(chapter, found, wave, counts)
    rounding(chapter)
    ritter = found["first order, Courant 0.9"].lines["Ritter"]
    for dx, error, prototype in zip((0.05, 0.025, 0.0125), ritter[1:], (0.0479, 0.0306, 0.0189), strict=False):
        chapter.claim(f"Ritter, first order, Courant 0.9, dx = {dx}: L1(h), at most that of the prototype, {prototype}",
                      error, high=prototype + 5e-5)  # fmt: skip
    shown = [
        replace(panel, lines={what: each for what, each in panel.lines.items() if what not in STRAIGHT})
        for panel in found.values()
    ]
    chapter.figure(picture([shown], "dx (dimensionless)", "L1(h)", (0.5, 1.0, 1.5)), "errors",
                   "Scheme 4 against exact solutions, closed form; wedges are in the tables.")  # fmt: skip


def converge(chapter: Chapter, name: str, counts: list[int]) -> Panel:
    """Halve dx."""
    method, number = METHODS[name]
    widths, found, rows = [14 / count for count in counts], {}, []
    for what, case in JUDGES.items():
        errors = case.errors(method, Courant(number, case.end), counts)
        found[what] = errors
        low, high = expected(what, method.order)
        if what in STRAIGHT and method.order == 2:
            rows.append([what, *errors, *[""] * (len(counts) - 1)])
            chapter.claim(f"{name}, {what}: L1(h), all dx", max(errors), high=1e-4)
            continue
        rows.append([what, *errors, *falls(widths, errors)])
        chapter.claim(f"{name}, {what}: order in dx", order(widths[-3:], errors[-3:]), low=low, high=high)
    heads = ["exact solution", *(f"dx = {width:.4g}" for width in widths), *["order"] * (len(counts) - 1)]
    chapter.table(f"L1(h), {name}", heads, rows)
    return Panel(name, widths, found)


def expected(what: str, of: int) -> tuple[float, float]:
    """Bounds of the order in dx: see the head of this page."""
    if of == 1:
        return SMOOTH if what in STRAIGHT else ROUGH
    return 0.5, 2.1


def smooth(chapter: Chapter, counts: list[int]) -> dict[str, list[float]]:
    """The simple wave."""
    wave, end = SimpleWave(), 0.3
    chapter.claim("simple wave: when it breaks, over the end of the runs", wave.breaks / end, low=1.5)
    rows, found = [], {}
    widths = [1 / count for count in counts]
    methods = METHODS | {
        "second order, mc, Courant 0.9": (Macroscopic(4, order=2, limiter="mc"), 0.9),
        "second order, minmod, Courant 0.9": (Macroscopic(4, order=2, limiter="minmod"), 0.9),
    }
    for name, (method, number) in methods.items():
        errors = wave.errors(method, number, counts, end)
        rows.append([name, *errors, *falls(widths, errors)])
        found[name] = errors
        reached = order(widths[-2:], errors[-2:])
        low = 0.9 if method.order == 1 else 1.8 if method.limiter == "minmod" else 1.9
        chapter.claim(f"simple wave, {name}: order in dx on the finest cells", reached, low=low, high=low + 0.4)
    chapter.table("L1(h) on a simple wave at t = 0.3", (
        "", *(f"dx = {width:.4g}" for width in widths), *["order"] * (len(counts) - 1)), rows)  # fmt: skip
    return found


def crossing(chapter: Chapter, counts: list[int]) -> None:
    """Waves that run both ways through each other: cells of which the fastest become faster within a step."""

    def start(count: int) -> Scene:
        cells = Cells(0.0, 1.0, count)
        y = 2 * np.pi * cells.x
        mean = np.sinc(1 / count)
        heap = Profile(1.0 + 0.2 * mean * np.sin(y), 0.1 * mean * np.cos(y))
        return Scene(cells, heap, friction=Frictionless(), boundary="periodic", epsilon=BETA)

    rows: list[list[str | float]] = []
    widths = [1 / count for count in counts[:-1]]
    limit = Solver.limit
    for limiter, number in (("between", 0.5), ("between", limit), ("mc", limit)):
        fine = family(list(map(start, counts)), Macroscopic(4, order=2, limiter=limiter), Courant(number, 0.3))
        heights = pairwise(run.arrays["h"] for run in fine)
        apart = [float(np.abs(b.reshape(-1, 2).mean(axis=1) - a).mean()) for a, b in heights]
        name = f"second order, {limiter}, Courant {number}"
        rows.append([name, *apart, *falls(widths, apart)])
        chapter.claim(f"waves of both families, {name}: order in dx on the finest cells",
                      order(widths[-2:], apart[-2:]), low=1.9, high=2.7)  # fmt: skip
    chapter.table("Waves of both families at t = 0.3: L1 of the difference of h from cells half as wide", (
        "", *(f"dx = {width:.4g}" for width in widths), *["order"] * (len(widths) - 1)), rows)  # fmt: skip


def compared(chapter: Chapter, found: dict[str, Panel], wave: dict[str, list[float]], counts: list[int]) -> None:
    """First over second order at dx = 0.05."""
    rows = []
    at = counts.index(280)
    for what in (*HALVED, "vacuum"):
        e = {name: panel.lines[what][at] for name, panel in found.items()}
        sharp = JUDGES[what]
        (mc,) = sharp.errors(Macroscopic(4, order=2, limiter="mc"), Courant(0.9, sharp.end), [280])
        rows.append(row(what, e, mc))
        chapter.claim(f"{what}, dx = 0.05, Courant 0.5 and 0.9: L1(h) of first order over that of second",
                      e[FIRST] / e[SECOND], low=3.5 if what in HALVED else 2.5)  # fmt: skip
    e = {name: errors[0] for name, errors in wave.items()}
    rows.append(row("simple wave", e, wave["second order, mc, Courant 0.9"][0]))
    chapter.claim(
        "simple wave, dx = 0.05, Courant 0.5 and 0.9: L1(h) of first order over that of second",
        e[FIRST] / e[SECOND],
        low=5.0,
    )
    chapter.table("L1(h) of first order over that of second, dx = 0.05", (
        "exact solution", "0.5 over 0.9", "0.9 over 0.9", "0.9 over 0.5", "mc, 0.5 over 0.9"), rows)  # fmt: skip


def row(what: str, e: dict[str, float], mc: float) -> list[str | float]:
    """Ratios of errors."""
    nine = e["first order, Courant 0.9"]
    return [what, e[FIRST] / e[SECOND], nine / e[SECOND], nine / e["second order, Courant 0.5"], e[FIRST] / mc]


def rounding(chapter: Chapter) -> None:
    """Slides and a pile: largest error of h and q at the end, over eps and the number of steps."""
    rows = []
    for what, case in SLIDES.items():
        worst = []
        for method, number in METHODS.values():
            worst.append(max(map(case.miss, case.runs(method, Courant(number, case.end), (70, 140)))))
        rows.append([what, *worst])
        chapter.claim(f"{what}: largest error of h and q, over eps and steps, all methods", max(worst), high=8.0)
    chapter.table("Largest error of h and q at the end, over eps and number of steps", ("", *METHODS), rows)


if __name__ == "__main__":
    run(main, __doc__)
