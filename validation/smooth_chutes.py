"""Smooth chutes: scheme 4 on a ground whose slope varies, (13).

The density of a cell carries the beta of its own cell, the force is the rigid shift of (23), and faces hold, or
reflect, what friction balances of beta h_x + beta' h/2. What that is worth:

- **Mass** stays to rounding between walls and round a ring, on bends as well, and no height and no density is negative.
- **Rest**: masses whose every face friction can balance stay bit for bit, wet and dry. A valley that is tilted lets its
  heap go at the angle at which the first face has to.
- **A steady stream** keeps its discharge to rounding, and its shape converges in both orders.
- **Friction of bends** slows, and never turns a mass round, however large eta is.
- **A slide round a bend** stops, and its deposit converges; the friction of the bend moves it uphill.
- **Both wings** agree as the velocity cell shrinks, to second order.
- **Where the mass leaves the ground**, friction is off, and the cells are named.

`hold` and `reflect` are both measured. Noise on piles tells them apart, as on a constant slope.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from claims import Chapter, run
from laboratory.chutes import admissible, wavy
from laboratory.pictures import COLOURS
from matplotlib.figure import Figure

from kinsim import (
    Arc,
    Cells,
    Coulomb,
    Courant,
    Expression,
    Fitted,
    Fixed,
    Inflow,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    SlopeFormula,
    SmoothChute,
    Uniform,
    load_scene,
    simulate,
    step,
)  # fmt: skip
from kinsim.exact import SteadyStream
from kinsim.plot.bed import Bed

Array = np.ndarray

HOLD, REFLECT, SECOND = Macroscopic(), Macroscopic(statics="reflect"), Macroscopic(order=2)
ROOMS = {
    "hold": HOLD, "reflect": REFLECT, "order 2": SECOND, "fitted": Kinetic(velocity=Fitted(6)),
    "64 nodes": Kinetic(velocity=Uniform(64)), "64 nodes, reflect": Kinetic(velocity=Uniform(64), statics="reflect"),
    "64 nodes, order 2": Kinetic(velocity=Uniform(64), order=2),
}  # fmt: skip


def main(chapter: Chapter) -> None:
    """Mass, rest, steady streams, friction, deposits, wings, lift."""
    conserved(chapter)
    resting(chapter)
    tilted(chapter)
    shaken(chapter)
    streaming(chapter)
    braked(chapter)
    stopped(chapter)
    agreeing(chapter)
    lifted(chapter)


def limit(method: Kinetic | Macroscopic) -> float:
    """A Courant number just below the largest one."""
    return 0.999


def conserved(chapter: Chapter) -> None:
    """Wild states, dry cells among them, thrown about on waves and between walls on slopes."""
    rows = []
    count, steps = (40, 1000) if chapter.full else (3, 60)
    for name, method in ROOMS.items():
        if not chapter.full and "nodes" in name and name != "64 nodes":
            continue
        drift, least, density = 0.0, math.inf, 0.0
        for seed in range(count if "nodes" not in name else max(count // 4, 1)):
            dice = np.random.default_rng(seed)
            h = 10.0 ** dice.uniform(-12.0, 0.5, 80) * (dice.random(80) < 0.8)
            u = np.where(h > 0, dice.normal(0.0, 2.0, 80), 0.0)
            scene = wavy(h, u, [0.0, 1.0, 1e4][seed % 3], ["wall", "periodic"][seed % 2])
            one = simulate(scene, method, Courant(limit(method), 1e3, most=steps), 10)
            start, end = (math.fsum(h) for h in one.h[[0, -1]])
            drift, least = max(drift, abs(end - start) / start), min(least, float(one.entries["h_min"].min()))
            density = min(density, float(np.nanmin(one.entries.get("f_min", np.zeros(2))[1:])))
        rows.append([name, drift, least, density])
        chapter.claim(f"{name}: mass drift in {steps} steps", drift, high=1e-14)
        chapter.claim(f"{name}: least height at Courant {limit(method)}", least, low=0.0)
        chapter.claim(f"{name}: least entry of f", density, low=0.0)
    chapter.table(
        f"{count} wild states, {steps} steps at the largest Courant number",
        ("", "mass drift", "least h", "least f"),
        rows,
    )


def resting(chapter: Chapter) -> None:
    """Random admissible masses; the claim is on bits."""
    rows, count = [], 20 if chapter.full else 2
    for name, method in ROOMS.items():
        if not chapter.full and "nodes" in name and name != "64 nodes":
            continue
        moved, wet = 0, 0
        for seed in range(count):
            dice = np.random.default_rng(seed)
            blank = wavy(np.zeros(80), delta=0.6)
            h = admissible(blank, dice, [0.0, 0.3, 1.0, 2.0][seed % 4], 1.0)
            wet += int((h > 0.0).sum())
            one = simulate(replace(blank, heap=Profile(h)), method, Fixed(0.01, 2000 if chapter.full else 60))
            moved += int(((one.h[-1] != h) | (one.q[-1] != 0.0)).sum())
        rows.append([name, count, wet, 80 * count - wet, moved])
        chapter.claim(f"{name}: cells of admissible masses that changed", moved, low=0, high=0)
    chapter.table("Random admissible masses on waves", ("", "masses", "wet cells", "dry cells", "cells changed"), rows)


def valley(tilt: float, count: int) -> Scene:
    """The heap of `rest-gallery` at the bottom, in a valley that is turned by `tilt`."""
    chute = SmoothChute(SlopeFormula(f"{tilt!r} - 0.35*tanh(x/2)"))
    heap = Expression("max(0, 0.6 - 0.35*abs(x))")
    return Scene(Cells(-6.0, 6.0, count), heap, chute, Coulomb(math.pi / 6), "wall", 0.4)


def beyond(tilt: float, x: Array) -> float:
    """By how much beta h_x + beta' h/2 = sin zeta asks for more than friction has, at the places x of that heap.

    Written out by hand for that heap and that valley, without cells.
    """
    zeta, rise = tilt - 0.35 * np.tanh(x / 2), -0.175 / np.cosh(x / 2) ** 2
    slope = 0.4 * (-0.35 * np.cos(zeta) * np.sign(x) - 0.5 * np.sin(zeta) * rise * (0.6 - 0.35 * np.abs(x)))
    return float((np.abs(np.sin(zeta) - slope) - np.cos(zeta) * math.tan(math.pi / 6)).max())


def at_faces(tilt: float, count: int) -> float:
    """The same at the faces of cells, toes included."""
    scene = valley(tilt, count)
    h, x = scene.initial()[0], scene.x
    zeta, dx = scene.chute.zeta(0.5 * (x[1:] + x[:-1]))[0], scene.cells.dx
    beta = 0.4 * np.cos(scene.chute.zeta(x)[0])
    slope = (0.5 * (beta[1:] + beta[:-1]) * np.diff(h) + 0.25 * np.diff(beta) * (h[1:] + h[:-1])) / dx
    over = np.abs(np.sin(zeta) - slope) - np.cos(zeta) * math.tan(math.pi / 6)
    return float(over[(h[1:] > 0) | (h[:-1] > 0)].max())


def tilted(chapter: Chapter) -> None:
    """The angle at which a heap starts, by bisection on runs, beside what friction can give.

    A face at the uphill toe shows a part of a step only, and `reflect` lets it go as soon as the ground below it is
    steeper than the angle of friction. `hold` lets a toe lean on what stands below it, and starts where a heap without
    cells does.
    """
    rows, heap = [], np.linspace(-0.6 / 0.35, 0.6 / 0.35, 100_000)
    whole = bisect(lambda tilt: beyond(tilt, heap) > 0.0)
    for count in (60, 120, 240)[: 3 if chapter.full else 1]:
        steepest = bisect(lambda tilt, count=count: at_faces(tilt, count) > 0.0)
        for name, right, within in (("hold", whole, 1.5), ("reflect", steepest, 1e-5)):

            def starts(tilt: float, count: int = count, name: str = name) -> bool:
                return bool(simulate(valley(tilt, count), ROOMS[name], Fixed(0.01, 20)).q.any())

            found = bisect(starts)
            rows.append([name, 12 / count, *(math.degrees(at) for at in (found, steepest, whole))])
            chapter.claim(f"{name}, {count} cells: tilt at which a heap starts less the right one, degrees",
                          math.degrees(found - right), low=-within, high=within)  # fmt: skip
    chapter.table("A valley is tilted until its heap starts, degrees",
                  ("", "dx", "starts at", "its steepest face", "without cells"), rows)  # fmt: skip


def bisect(beyond: Callable[[float], bool], low: float = 0.0, high: float = 0.8) -> float:
    """Where `beyond` becomes true."""
    for _ in range(26):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if beyond(middle) else (middle, high)
    return 0.5 * (low + high)


def shaken(chapter: Chapter) -> None:
    """Noise on admissible masses that take all, or most, of what friction can give."""
    rows = []
    for share in (1.0, 0.8):
        for name in ("hold", "reflect"):
            change, still = 0.0, 0
            for seed in range(4 if chapter.full else 2):
                blank = wavy(np.zeros(80), delta=0.6)
                h = admissible(blank, np.random.default_rng(seed), 1.5, share)
                dice = np.random.default_rng(100 + seed)
                noisy = h * (1.0 + 1e-8 * dice.uniform(-1.0, 1.0, 80)), 1e-8 * dice.uniform(-1.0, 1.0, 80)
                clock = Courant(0.9, 1e3, most=4000 if chapter.full else 300)
                one = simulate(replace(blank, heap=Profile(*noisy)), ROOMS[name], clock)
                change, still = max(change, float(np.abs(one.h[-1] - h).max())), still + (not one.q[-1].any())
            rows.append([f"{100 * share:.0f} %", name, change, f"{still}"])
            if name == "hold" or share < 1.0:
                chapter.claim(f"{name}, filled to {100 * share:.0f} percent: change of h by noise of 1e-8", change,
                              high=1e-5)  # fmt: skip
    chapter.table("Masses at rest, disturbed by 1e-8", ("filled", "", "largest change of h", "stopped again"), rows)


def streaming(chapter: Chapter) -> None:
    """A stream on an arc against its ordinary differential equation."""
    chute, friction = SmoothChute(Arc(6.0, 0.45, 2.0), 0.7), Coulomb(0.4)
    exact = SteadyStream(chute, friction, 0.4, 0.6, 2.0, 0.0, 4.0)
    sizes = (32, 64, 128, 256, 512) if chapter.full else (32, 64)
    rows = []
    for name in ("hold", "reflect", "fitted", "order 2") if chapter.full else ("hold", "order 2"):
        errors, spread = [], 0.0
        for count in sizes:
            cells = Cells(0.0, 4.0, count)
            h, u = exact(cells.x)
            scene = Scene(cells, Profile(h, u), chute, friction, (Inflow(0.3, 2.0), "open"), 0.4)
            one = simulate(scene, ROOMS[name], Courant(0.9, 20.0), 1)
            errors.append(float(np.abs(one.u[-1] - u)[count // 8 : -count // 8].mean()))
            h, q, dt = one.h[-3], one.q[-3], one.dt[-2]  # the last step is shorter, and order 2 rests at one dt only
            spread = max(spread, float(np.ptp(step(scene, ROOMS[name], h, q, dt).flux[0])))
        order = math.log2(errors[-2] / errors[-1])
        rows.append([name, *errors, order, spread])
        least = 1.8 if name == "order 2" else 0.95
        chapter.claim(f"{name}: order of the steady stream on an arc", order, low=least, high=least + 0.75)
        chapter.claim(f"{name}: spread of the discharge of the steady stream", spread, high=1e-13)
    chapter.table("Mean error of u of a steady stream on an arc, and spread of its discharge",
                  ("", *(f"{count} cells" for count in sizes), "order", "spread of q"), rows)  # fmt: skip


def braked(chapter: Chapter) -> None:
    """A stream at the bottom of a bowl, with eta up to 1e4: it slows, and never turns."""
    rows, count = [], 24
    for eta in (0.0, 1.0, 1e2, 1e4) if chapter.full else (1e4,):
        for name in ("hold", "reflect", "order 2"):
            heap = Profile(np.ones(count), np.full(count, 3.0))
            scene = Scene(Cells(-0.012, 0.012, count), heap, SmoothChute(Arc(5.0), eta), Coulomb(0.4), "open", 0.4)
            one = simulate(scene, ROOMS[name], Fixed(1e-4, 400), 1)
            middle = one.u[:, count // 2 - 1 : count // 2 + 1]
            rows.append(
                [eta, name, float(middle[-1].mean()), float(middle.min()), float(np.diff(middle, axis=0).max())]
            )
            chapter.claim(f"{name}, eta = {eta:g}: least velocity of a stream that is braked", middle.min(), low=0.0)
            chapter.claim(f"{name}, eta = {eta:g}: largest rise of its velocity in a step",
                          np.diff(middle, axis=0).max(), high=1e-7)  # fmt: skip
    chapter.table("A stream with u = 3 on an arc of radius 5, after t = 0.04", (
        "eta", "", "u at the end", "least u", "largest rise in a step"), rows)  # fmt: skip


def stopped(chapter: Chapter) -> None:
    """The slide round a bend, ever finer, with and without the friction of the bend."""
    sizes = (160, 320, 640, 1280, 2560) if chapter.full else (80, 160)
    rows, halved, centres, runs = [], [], {}, {}
    for eta in (0.0, 1.0):
        for name in ("reflect", "hold", "order 2"):
            for count in sizes:
                scene, _, _ = load_scene("bend")
                scene = replace(scene, cells=replace(scene.cells, count=count), chute=replace(scene.chute, eta=eta))
                one = simulate(scene, ROOMS[name], Courant(0.9, 250.0, stop_at_rest=True), 20 * count // 160 + 1)
                h, x = one.h[-1], one.x
                deep = x[h > 1e-2]
                centres[eta, name, count] = float((x * h).sum() / h.sum())
                runs[eta, name, count] = one
                rows.append([eta, name, count, float(one.t[-1]), deep[0], deep[-1], float(h.max()),
                             float(x[h.argmax()]), centres[eta, name, count]])  # fmt: skip
                chapter.claim(
                    f"bend, eta = {eta:g}, {name}, {count} cells: mass drift", abs(one.mass_drift), high=1e-14
                )
                chapter.claim(f"bend, eta = {eta:g}, {name}, {count} cells: largest |q| of the deposit",
                              np.abs(one.q[-1][h > 1e-9]).max(), high=0.0)  # fmt: skip
            steps = [apart(runs[eta, name, a].h[-1], runs[eta, name, b].h[-1], 32.0 / b)
                     for a, b in itertools.pairwise(sizes)]  # fmt: skip
            halved.append([eta, name, *steps])
            if chapter.full:
                chapter.claim(f"bend, eta = {eta:g}, {name}: last change of the deposit by finer cells over the first",
                              steps[-1] / steps[0], high=0.5)  # fmt: skip
    finest = sizes[-1]
    for name in ("reflect", "hold", "order 2"):
        chapter.claim(f"bend, {name}: the friction of the bend moves the deposit uphill by",
                      centres[0.0, name, finest] - centres[1.0, name, finest], low=2.4, high=2.8)  # fmt: skip
    chapter.table("The deposit behind a bend", (
        "eta", "", "cells", "rests at t", "from x", "to x", "highest", "at x", "centre of mass"), rows)  # fmt: skip
    pairs = (f"{a} to {b} cells" for a, b in itertools.pairwise(sizes))
    chapter.table("By how much finer cells change the deposit: L1(h)", ("eta", "", *pairs), halved)
    one = runs[0.0, "reflect", 160]
    deposit = one.h[-1] > 1e-12
    again = simulate(replace(one.scene, heap=Profile(one.h[-1], one.u[-1])), REFLECT, Fixed(0.01, 500))
    chapter.claim("bend, reflect: cells of the deposit that change in 500 steps more",
                  int((again.h[-1] != one.h[-1])[deposit].sum()), low=0, high=0)  # fmt: skip
    chapter.figure(draw(runs, sizes), "bend", "The slide round a bend, and its deposits on ever finer cells.")


def apart(coarse: Array, fine: Array, dx: float) -> float:
    """L1 distance of heights on cells and on halves of them, of length dx."""
    return float(np.abs(np.repeat(coarse, 2) - fine).sum()) * dx


def draw(runs: dict[tuple[float, str, int], object], sizes: tuple[int, ...]) -> Figure:
    """The slide on the chute for both eta, and deposits below."""
    figure = Figure(figsize=(11, 8.2), layout="constrained")
    upper, lower = figure.subplots(2, 2)
    for axes, eta in zip(upper, (0.0, 1.0), strict=True):
        one = runs[eta, "reflect", sizes[-1]]
        bed = Bed.of(one.scene, 1.0)
        bed.draw(axes)
        for number, time in enumerate((0.0, 5.0, 9.0, 13.0, one.t[-1])):
            row = int(np.argmin(np.abs(one.t - time)))
            axes.fill(*bed.outline(one.h[row]).T, color=COLOURS[number], alpha=0.35, linewidth=0)
            axes.plot(*bed.surface(one.h[row]), color=COLOURS[number], linewidth=1.2, label=f"t = {one.t[row]:.3g}")
        axes.set_title(f"eta = {eta:g}, {bed.words}", loc="left", fontsize=10)
        axes.legend(frameon=False, fontsize=8)
    for axes, eta in zip(lower, (0.0, 1.0), strict=True):
        for number, count in enumerate(sizes):
            for name, line in (("reflect", "-"), ("order 2", "--")):
                one = runs[eta, name, count]
                axes.plot(one.x, one.h[-1], line, color=COLOURS[number], linewidth=1.3, label=f"{name}, {count} cells")
        axes.set_xlim(19, 30)
        axes.set_xlabel("x along the chute (dimensionless)")
        axes.set_ylabel("height h at rest")
        axes.grid(alpha=0.25)
    lower[0].legend(frameon=False, fontsize=8)
    return figure


def agreeing(chapter: Chapter) -> None:
    """The wings on a smooth wave over waves, by the size of the velocity cell."""
    x = Cells(0.0, 2.0 * math.pi, 80).x
    scene = wavy(1.0 + 0.3 * np.sin(x), 0.2 * np.cos(x), 1.0, "periodic")
    counts, rows = (32, 64, 128, 256, 512)[: 5 if chapter.full else 3], []
    for name in ("hold", "reflect", "order 2"):
        exact = simulate(scene, ROOMS[name], Fixed(0.01, 60))
        errors = []
        for count in counts:
            way = ROOMS[name]
            method = Kinetic(velocity=Uniform(count, 4.0), order=way.order, statics=way.statics)
            one = simulate(scene, method, Fixed(0.01, 60))
            errors.append(float(np.abs(one.h[-1] - exact.h[-1]).mean() + np.abs(one.q[-1] - exact.q[-1]).mean()))
        order = math.log2(errors[0] / errors[-1]) / (len(counts) - 1)
        rows.append([name, *errors, order])
        chapter.claim(f"{name}: order of kinetic against closed form in the velocity cell", order, low=1.9, high=3.0)
    chapter.table("Kinetic against closed form: mean difference of h and q", (
        "", *(f"{count} nodes" for count in counts), "order"), rows)  # fmt: skip


def lifted(chapter: Chapter) -> None:
    """Scenes in which the mass leaves the ground, and one that is told to stop there."""
    rows = []
    for name, (low, high) in {"jump": (8.5, 12.5), "crest": (2.5, 6.0)}.items():
        scene, _, clock = load_scene(name)
        for room in ("hold", "reflect"):
            one = simulate(scene, ROOMS[room], clock)
            books = {key: float(one.entries[key][-1]) for key in ("lifted_from", "lifted_to", "lifted_since")}
            most = int(one.entries["lifted"].max())
            rows.append([name, room, most, *books.values(), float(one.entries["normal_force"][-1])])
            chapter.claim(f"{name}, {room}: leftmost x where cells leave the ground", books["lifted_from"], low=low)
            chapter.claim(f"{name}, {room}: rightmost x where cells leave the ground", books["lifted_to"], high=high)
        strict = replace(scene, chute=replace(scene.chute, lifting="stop"))
        one = simulate(strict, HOLD, clock)
        chapter.claim(f"{name}, strict: time of the stop less the first time of lift, in steps",
                      (one.t[-1] - one.entries["lifted_since"][-1]) / one.dt[-1], low=0.0, high=0.0)  # fmt: skip
        chapter.claim(f"{name}, strict: stops as lifted-off", one.verdict.kind == "lifted-off", low=1, high=1)
    chapter.table("Where the mass leaves the ground", (
        "scene", "", "most cells", "from x", "to x", "first at t", "least normal force"), rows)  # fmt: skip


if __name__ == "__main__":
    run(main, __doc__)
