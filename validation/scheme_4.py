"""What schemes 1 to 4 promise and keep: a table of properties.

The schemes of the paper lose mass at mixed faces, fall below zero, cannot stand on dry ground, keep zigzags, and slide
away above the friction angle. Scheme 4 is our repair: at faces that friction can hold, a part of the density is held
back (or particles are reflected); each face has one flux; one clamped impulse per cell does the rest. Here every
promise is measured on every scheme, closed form, at 0.9 of its largest Courant number unless said otherwise.

Where the printed schemes break a promise, that is claimed, too: a repair of nothing would be none.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from claims import Chapter, run
from laboratory.repaired import DELTA, REPAIRED, SCHEMES, Array, courant, pile, scene_of, shaken, steps

from kinsim import Courant, Fixed, Macroscopic, Profile, load_scene, simulate, step
from kinsim.exact import Riemann
from kinsim.run import ENDED

SEEDS = range(2)
Measure = Callable[[Macroscopic, bool], float]
"""A method, and whether the full size is asked for, to what is measured."""


def main(chapter: Chapter) -> None:
    """Measure all, claim what scheme 4 keeps and what the others break."""
    rows = []
    for promise in PROMISES:
        found = {name: promise.measure(method, chapter.full) for name, method in SCHEMES.items()}
        rows.append([promise.says, *(_word(value) for value in found.values())])
        for name in REPAIRED:
            if name not in promise.exempt:
                chapter.claim(f"scheme {name}: {promise.says}", found[name], low=promise.low, high=promise.high)
        for name, least in promise.broken.items():
            chapter.claim(f"scheme {name} breaks it: {promise.says}", found[name], low=least)
    chapter.table("Properties of the schemes", ("", *SCHEMES), rows)
    prices(chapter)


def wild(seed: int) -> tuple[Array, Array]:
    """Dry cells, 1e-300, 1e-12 and O(1) mixed, |u| up to 2."""
    dice = np.random.default_rng(seed)
    h = dice.choice([0.0, 1e-300, 1e-12, 1.0], 60) * dice.uniform(0.1, 1.0, 60)
    u = dice.uniform(-1, 1, 60) * dice.choice([0.0, 0.1, 2.0], 60)
    return h, np.where(h > 0, u, 0.0)


def wet(seed: int) -> tuple[Array, Array]:
    """Heights from 0.2 to 1, slow and fast."""
    dice = np.random.default_rng(seed)
    return dice.uniform(0.2, 1.0, 60), dice.uniform(-1, 1, 60) * dice.choice([0.0, 0.01, 1.0], 60)


def drift(method: Macroscopic, full: bool) -> float:
    """Largest relative change of mass in 200 steps of random states between walls and on a ring."""
    return max(_drift(method, *wet(seed), ends) for seed in SEEDS for ends in ("wall", "periodic"))


def drift_dry(method: Macroscopic, full: bool) -> float:
    """The same with dry ground."""
    return max(_drift(method, *wild(seed), ends) for seed in SEEDS for ends in ("wall", "periodic"))


def _drift(method: Macroscopic, h: Array, u: Array, ends: str) -> float:
    scene = scene_of(h, u, zeta=0.2, delta=DELTA, ends=ends)
    for h1, _, _ in steps(scene, method, h, h * u, 200, courant(method)):
        last = h1
    return abs(math.fsum(last) / math.fsum(h) - 1.0) if np.isfinite(last).all() else math.inf


def lowest(method: Macroscopic, full: bool) -> float:
    """How far heights fall below 0 in 200 steps of random states with dry ground; infinite if they end in no number."""
    worst = 0.0
    for seed in SEEDS:
        h, u = wild(seed)
        scene = scene_of(h, u, zeta=0.2, delta=DELTA)
        for h1, q1, _ in steps(scene, method, h, h * u, 200, courant(method)):
            least = float(h1.min())
            worst = max(worst, -least) if np.isfinite(q1).all() and np.isfinite(least) else math.inf
    return worst


def at_rest(zeta: float, noise: float, lowest: float) -> Measure:
    """Largest change of h (and q, without noise) of piles that friction holds by 100 percent; Courant number 0.45.

    At that number rest is stable under schemes 2 and 3, too, see the chapter on limits.
    """

    def measure(method: Macroscopic, full: bool) -> float:
        worst, count = 0.0, 2000 if full else 400
        for seed in SEEDS:
            scene = pile(zeta, seed, lowest)
            start, _ = scene.initial()
            h, q = shaken(scene, noise, seed) if noise else scene.initial()
            for h1, q1, _ in steps(scene, method, h, q, count, 0.45):
                off = np.abs(h1 - start).max() + (np.abs(q1).max() if not noise else 0.0)
                if not np.isfinite(off):
                    return math.inf
                worst = max(worst, float(off))
        return worst

    return measure


def zigzag(method: Macroscopic, full: bool) -> float:
    """What is left at t = 20 of an odd-even pile of +-0.1, steeper than friction holds at each face."""
    h = 1.0 + 0.1 * (-1.0) ** np.arange(40)
    end = simulate(scene_of(h, delta=DELTA, ends="periodic"), method, Courant(courant(method, 0.45), 20.0), 10**6).h[-1]
    return float(0.5 * np.abs(np.diff(end)).max())


def chatter(method: Macroscopic, full: bool) -> float:
    """`sine`, whose heights are moved by 1e-13: largest difference of h until t = 4; dt = 0.004."""
    scene, _, _ = load_scene("sine")
    h, _ = scene.initial()
    nudged = replace(scene, heap=Profile(h * (1 + 1e-13 * np.random.default_rng(0).standard_normal(h.size))))
    one, other = (simulate(each, method, Fixed(4e-3, 1000), 250) for each in (scene, nudged))
    return float(np.abs(one.h - other.h).max())


def variation(method: Macroscopic, full: bool) -> float:
    """`riemann` at t = 5: total variation of h beyond that of the exact solution, 1/2."""
    scene, _, _ = load_scene("riemann")
    end = simulate(scene, method, Courant(courant(method), 5.0), 10**6).h[-1]
    return float(np.abs(np.diff(end)).sum() - 0.5)


def film(method: Macroscopic, full: bool) -> float:
    """A column breaks onto dry ground and onto a film of 1e-12, with friction: L1 of the difference at t = 1."""
    x = (np.arange(80) + 0.5) / 80
    ends = []
    for depth in (0.0, 1e-12):
        scene = scene_of(np.where(np.abs(x - 0.4) < 0.2, 1.0, depth), delta=DELTA, ends="open")
        one = simulate(scene, method, Courant(courant(method), 1.0), 10**6)
        if one.verdict.kind not in ENDED:
            return math.inf
        ends.append(one.h[-1])
    return float(0.05 * np.abs(ends[0] - ends[1]).sum())


def mirror(method: Macroscopic, full: bool) -> float:
    """Largest difference of a step of random states and its mirror image."""
    worst = 0.0
    for seed in SEEDS:
        h, u = wet(seed)
        u[20:40] = 0.0
        g, v = h[::-1].copy(), -u[::-1]
        one = step(scene_of(h, u, zeta=0.2, delta=DELTA), method, h, h * u, 0.004)
        other = step(scene_of(g, v, zeta=-0.2, delta=DELTA), method, g, g * v, 0.004)
        worst = max(worst, np.abs(one.h1 - other.h1[::-1]).max(), np.abs(one.q1 + other.q1[::-1]).max())
    return worst


def motion(film: float) -> Measure:
    """Largest |u| at t = 30 of a column that broke between walls, zeta = 0.15 and -0.25, delta = 0.3."""

    def measure(method: Macroscopic, full: bool) -> float:
        x, worst = (np.arange(48) + 0.5) / 48, 0.0
        for zeta in (0.15, -0.25):
            h = np.where(np.abs(x - 0.5) < 0.15, 1.0, film)
            scene = scene_of(h, 0.5 * (h > 0.5), zeta=zeta, delta=DELTA)
            one = simulate(scene, method, Courant(courant(method, 0.45), 30.0), 10**6)
            if one.verdict.kind not in ENDED:
                return math.inf
            worst = max(worst, float(np.abs(one.u[-1]).max()))
        return worst

    return measure


@dataclass(frozen=True)
class Promise:
    """One line of the table: what is measured, in which bounds scheme 4 keeps it, who breaks it by how much at least.

    Attributes:
        says: What is measured.
        measure: How.
        high, low: Bounds for scheme 4.
        broken: By which of the printed schemes, at least by how much.
        exempt: Variants of scheme 4 that do not promise it.
    """

    says: str
    measure: Measure
    high: float
    broken: dict[str, float]
    exempt: tuple[str, ...] = ()
    low: float = -math.inf


PROMISES = (
    Promise("mass, wet: relative change in 200 steps", drift, 1e-14, {"3": 1e-4}),
    Promise("mass, dry ground: relative change in 200 steps", drift_dry, 1e-14, {}),
    Promise("least height below 0, dry ground", lowest, 0.0, {"2": 1e-3, "3": 1e-3}),
    Promise("wet pile at 100 % of the bound, zeta = delta/2: change of h and q", at_rest(0.15, 0.0, 0.3), 0.0,
            {"1": 1e-3}),
    Promise("wet pile, zeta = 2 delta", at_rest(0.6, 0.0, 0.3), 0.0, {"1": 1e-3, "2": 1e-3, "3": 1e-3}),
    Promise("pile with a dry toe, zeta = delta/2", at_rest(0.15, 0.0, 0.0), 0.0, {"1": 1e-3, "2": 1e-3}),
    Promise("pile with a dry toe, zeta = 2 delta", at_rest(0.6, 0.0, 0.0), 0.0, {"1": 1e-3, "2": 1e-3}),
    Promise("wet pile, zeta = delta/2, noise of 1e-8: change of h", at_rest(0.15, 1e-8, 0.3), 1e-6, {"1": 1e-3},
            ("4, reflecting",)),
    Promise("wet pile, zeta = 2 delta, noise of 1e-8", at_rest(0.6, 1e-8, 0.3), 1e-6, {"1": 1e-3}, ("4, reflecting",)),
    Promise("zigzag of 0.1, what is left", zigzag, 0.5 * 0.05 * math.tan(DELTA) / 0.4 * 1.001, {"2": 0.09}),
    Promise("`sine`: growth of 1e-13", chatter, 1e-11, {"3": 1e-7}),
    Promise("`riemann`: excess of total variation", variation, 2e-3, {"2": 1e-2}),
    Promise("dry bed against a film of 1e-12, L1(h)", film, 1e-10, {}),
    Promise("mirror image", mirror, 0.0, {}),
    Promise("column on a wet bed between walls: largest |u| at t = 30", motion(0.2), 0.0, {"1": 1e-5}),
    Promise("column on dry ground between walls: largest |u| at t = 30", motion(0.0), 0.0, {"1": 1e-5}),
)  # fmt: skip


def prices(chapter: Chapter) -> None:
    """What it costs, and what an error it makes: the dam break without friction, dx = 0.05."""
    exact = Riemann(1, 0, 0.5, 0, 0.4)
    scene = load_scene("riemann")[0]
    rows = []
    for name, method in SCHEMES.items():
        one = simulate(scene, method, Courant(courant(method), 5.0), 10**6)
        h, q = scene.initial()
        began = time.perf_counter()
        taken = sum(1 for _ in steps(scene, method, h, q, 400, courant(method)))
        cost = (time.perf_counter() - began) / (taken * h.size)
        off = np.abs(one.h[-1] - exact.averages(scene.cells, 5.0)[0]).sum() * scene.cells.dx
        rows.append([name, float(off), one.steps, 1e9 * cost])
    chapter.table("`riemann` at t = 5: error, steps, and time per step and cell (one core of a shared machine)",
                  ("scheme", "L1(h)", "steps", "ns"), rows)  # fmt: skip


def _word(value: float) -> str:
    if math.isinf(value):
        return "no number"
    return "0" if value == 0.0 else f"{value:.2g}"


if __name__ == "__main__":
    run(main, __doc__)
