"""The kinetic entropy under scheme 4: proved where nothing is held, measured where faces hold, friction work booked.

H(f, xi) = xi^2 f/2 + (pi^2 beta^2/6) f^3 is convex in f, and M is its minimum at given (h, q). Upwind transport makes
f a mean of densities, so that no cell between two faces that hold nothing produces entropy: that is proved, and here
tried on random states at a Courant number of 1. Where a face holds something back, cells do not see the density of
their neighbour as it is, and nothing is proved: what they produce is measured, in runs that start, slide and stop.
It is never more than the pull G = |sin zeta| + R can give back within the step, (dt G)^2 h/2: transport hands a resting
cell the momentum that its faces leave unbalanced, and the clamped shift, which comes after it, takes it away again. On
flat ground, friction alone does that, and transport and friction together never produced any.

The sum over a run closes: entropy at the end less that at the start = production + work of gravity + work of friction
- outflow. Friction takes R |q| per length and time of what slides; what it takes beyond is what stops.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from claims import Chapter, run
from laboratory.pictures import COLOURS
from laboratory.repaired import DELTA, Array, pile, scene_of, shaken, steps
from matplotlib.figure import Figure

from kinsim import Cells, Macroscopic, Profile, Scene, load_scene, step
from kinsim.measure.entropy import entropy

EPS = float(np.finfo(float).eps)


def main(chapter: Chapter) -> None:
    """Random states, then whole runs."""
    proved(chapter, 400 if chapter.full else 60)
    found = {}
    rows = []
    for name, scene, start, end in scenes():
        found[name] = book = follow(scene, *start, end)
        rows.append([name, book.gained[-1], book.free[-1], book.at_held[-1], book.gravity[-1], book.friction[-1],
                     book.outflow[-1], book.worst_held, book.worst_net])  # fmt: skip
        if book.free[-1] < 0:
            chapter.claim(f"{name}: largest production of a cell in a step where nothing is held, over rounding",
                          book.worst_free, high=1.0)  # fmt: skip
            chapter.claim(f"{name}: production in all, over the entropy", book.free[-1] + book.at_held[-1], high=0.0)
        chapter.claim(f"{name}: largest production of a cell in a step at held faces, over (dt G)^2 h/2",
                      book.worst_held, high=1.0)  # fmt: skip
        if scene.chute.sin == 0.0:
            chapter.claim(f"{name}: largest production of a cell in a step at held faces, friction included, "
                          "over (dt G)^2 h/2", book.worst_net, high=1e-9)  # fmt: skip
        gap = book.gained - book.free - book.at_held - book.gravity - book.friction + book.outflow
        chapter.claim(f"{name}: what the books leave open, over the entropy", np.abs(gap).max(), high=1e-12)
        if book.sliding is not None:
            chapter.claim(f"{name}: work of friction over -R |q| in time, cells that slide",
                          book.sliding, low=1 - 1e-9, high=1 + 1e-9)  # fmt: skip
    heads = ("run", "gained", "produced where nothing is held", "... at held faces", "gravity", "friction", "outflow",
             "largest production", "... with friction")  # fmt: skip
    caption = (
        "Entropy at the end, each part over the entropy at the start; largest production of a cell in a step at held"
    )
    chapter.table(f"{caption} faces, over (dt G)^2 h/2", heads, rows)
    chapter.figure(draw(found["silo on dry ground"]), "silo", "Where the entropy of a collapsing column goes.")


def scenes() -> list[tuple[str, Scene, tuple[Array, Array], float]]:
    """What is followed."""
    silo = replace(load_scene("silo")[0], cells=Cells(-8, 8, 160))
    dry = np.where(np.abs(silo.x) < 1, 2.3, 0.0)
    silo = replace(silo, heap=Profile(dry))
    sine = replace(load_scene("sine")[0], cells=Cells(-3, 11, 140))
    steep = pile(2 * DELTA, 1, 0.3)
    x = (np.arange(60) + 0.5) / 60
    wall = scene_of(np.where(x < 0.4, 1.0, 0.1), zeta=0.2, delta=DELTA)
    return [
        ("silo on dry ground", silo, silo.initial(), 6.0), ("sine", sine, sine.initial(), 3.0),
        ("dam between walls", wall, wall.initial(), 6.0), ("disturbed pile", steep, shaken(steep, 1e-4), 2.0),
    ]  # fmt: skip


def proved(chapter: Chapter, seeds: int) -> None:
    """Random states with dry cells at a Courant number of 1."""
    worst, cells = -np.inf, 0
    for seed in range(seeds):
        dice = np.random.default_rng(seed)
        h = dice.choice([0.0, 1e-300, 1e-12, 1.0], 60) * dice.uniform(0.1, 1.0, 60)
        u = np.where(h > 0, dice.uniform(-1, 1, 60) * dice.choice([0.0, 0.1, 2.0], 60), 0.0)
        scene = scene_of(h, u, zeta=(-0.6, 0.0, 0.3)[seed % 3], delta=DELTA, ends=("wall", "periodic")[seed % 2])
        speed = float((np.abs(u) + np.sqrt(2 * scene.beta * h)).max())
        dt = math.nextafter(scene.cells.dx / speed, 0.0)
        found = entropy(scene, step(scene, Macroscopic(4), h, h * u, dt))
        worst = max(worst, float(found.production[found.free].max()) / (EPS * speed**2))
        cells += int(found.free.sum())
    chapter.claim(f"{cells} cells of random states with dry ground, Courant number 1, nothing held: largest production "
                  "over eps max(h) speed^2", worst, high=64.0)  # fmt: skip


@dataclass(frozen=True)
class Book:
    """Entropy over time, each part summed over cells and steps, over the entropy at the start.

    Attributes:
        t: Times.
        gained, free, at_held, gravity, friction, outflow: The parts.
        worst_free: Largest production of a cell in a step without held faces, over rounding.
        worst_held: The same with held faces, over (dt G)^2 h/2, h the largest of the cell and its neighbours.
        worst_net: The same, with the work of friction.
        sliding: Work of friction over -R |q| in time, cells that slide between free faces; None if none does.
    """

    t: Array
    gained: Array
    free: Array
    at_held: Array
    gravity: Array
    friction: Array
    outflow: Array
    worst_free: float
    worst_held: float
    worst_net: float
    sliding: float | None


def follow(scene: Scene, h: Array, q: Array, end: float) -> Book:
    """Take every step of first order at a Courant number of 0.9."""
    t, parts, worst, work, way = [0.0], [np.zeros(6)], [-np.inf] * 3, 0.0, 0.0
    before, first = (h, q), None
    for h1, q1, dt in steps(scene, Macroscopic(4), h, q, 10**6, 0.9):
        now = step(scene, Macroscopic(4), *before, dt)
        found = entropy(scene, now)
        first = first or float(found.before.sum())
        tiny = 64 * EPS * first
        free = found.free
        parts.append(np.array([
            (found.after - found.before).sum(), found.production[free].sum(), found.production[~free].sum(),
            found.gravity.sum(), found.friction.sum(), found.outflow.sum(),
        ]) / first)  # fmt: skip
        if free.any():
            worst[0] = max(worst[0], float(found.production[free].max()))
        around = np.pad(now.h, 1, mode="edge")
        high = np.maximum(np.maximum(around[:-2], around[2:]), now.h)
        at = ~free & (high > 0)
        if at.any():
            unit = 0.5 * (dt * (abs(scene.chute.sin) + scene.resistance)) ** 2 * high[at]
            worst[1] = max(worst[1], float((found.production[at] / unit).max()))
            worst[2] = max(worst[2], float(((found.production + found.friction)[at] / unit).max()))
        sliding = free & (now.qhat * now.q1 > 0)
        work += float(found.friction[sliding].sum())
        way += float(-dt * scene.resistance * 0.5 * np.abs(now.qhat + now.q1)[sliding].sum())
        before = (h1, q1)
        t.append(t[-1] + dt)
        if t[-1] > end:
            break
    sums = np.cumsum(parts, axis=0).T
    return Book(np.array(t), *sums, worst[0] / tiny, worst[1], worst[2], work / way if way else None)


def draw(book: Book) -> Figure:
    """The parts over time."""
    figure = Figure(figsize=(8, 4.4), layout="constrained")
    axes = figure.subplots()
    lines = {
        "entropy": 1 + book.gained, "dissipated where nothing is held": book.free,
        "dissipated where faces hold": book.at_held, "work of friction": book.friction,
    }  # fmt: skip
    for number, (name, values) in enumerate(lines.items()):
        style = ("-", "--", "-.", ":")[number]
        axes.plot(book.t, values, style, color=COLOURS[number], linewidth=1.8, label=name)
    axes.axhline(0, color="0.6", linewidth=1)
    axes.set_title("silo on dry ground, scheme 4, dx = 0.1", loc="left", fontsize=10)
    axes.set(xlabel="t (dimensionless)", ylabel="over the entropy at the start")
    axes.legend(frameon=False)
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    return figure


if __name__ == "__main__":
    run(main, __doc__)
