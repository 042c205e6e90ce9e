"""Hold or reflect: two rooms for the faces that friction can hold, measured against each other.

Held faces keep back a part of the density, in a way that fades out as a face begins to move; no dt is in it. Static
faces turn all particles round, and are static or not: a switch, with dt in it. Both conserve mass, keep h >= 0 and keep
rest bitwise. What differs:

- **Disturbed piles.** Piles that take all of what friction can give are disturbed by noise. Held faces bring them back
  to rest within some times the noise. Reflection opens a face that is too steep by a rounding, and its cells then send
  what only the closed face had held: above the friction angle the pile slides away, below it moves by some
  thousandths before it stops. Piles that take 80 percent stop under both.
- **Ends of motion.** Columns that break on dry ground, not steep enough to drive them, stop under both with q = 0, a
  little earlier where faces reflect, and with a shorter film before them where faces hold.
- **Accuracy** on the exact solutions: the same on all that moves, as both rooms are then scheme 1; where something
  starts or stops within a few percent of each other.
- **Cost**: of the same size, reflection a little cheaper.

On a constant slope `hold` is the default, for what it does to disturbed piles; `reflect` is kept, since on curved
chutes it needs no balanced jump of heights.
"""

from __future__ import annotations

import statistics
import time
from dataclasses import replace

import numpy as np
from claims import Chapter, run
from laboratory.judged import CASES
from laboratory.pictures import COLOURS, MARKS
from laboratory.repaired import DELTA, Array, courant, pile, scene_of, shaken, steps
from matplotlib.figure import Figure

from kinsim import Courant, Macroscopic, load_scene, simulate

ROOMS = {"hold": Macroscopic(4), "reflect": Macroscopic(4, statics="reflect")}
NOISES = (1e-12, 1e-8, 1e-6, 1e-4)
PROTOTYPE = {320: 3.306, 640: 3.391, 1280: 3.451}
"""Front of `silo` at rest, by number of cells."""

SLOPES = {"delta/2": DELTA / 2, "delta": DELTA, "2 delta": 2 * DELTA}


def main(chapter: Chapter) -> None:
    """Disturbed piles, accuracy, films, cost."""
    moved = disturbed(chapter)
    accuracy(chapter)
    creeping(chapter)
    cost(chapter)
    chapter.figure(draw(moved), "disturbed", "Largest change of h of piles that friction holds, by the noise that "
                   "disturbs them.")  # fmt: skip


def disturbed(chapter: Chapter) -> dict[tuple[str, str, float], Array]:
    """Noise of several sizes on piles filled to 100 and 80 percent; change of h over the noise's own."""
    found, rows = {}, []
    count, seeds = (2000, range(3)) if chapter.full else (400, range(2))
    for fill in (1.0, 0.8):
        for slope, zeta in SLOPES.items():
            for room, method in ROOMS.items():
                changes, moving = [], []
                for noise in NOISES:
                    worst, fast = 0.0, 0.0
                    for seed in seeds:
                        scene = pile(zeta, seed, 0.3, fill)
                        *_, (h, q, _) = steps(scene, method, *shaken(scene, noise, seed), count, courant(method))
                        worst = max(worst, float(np.abs(h - scene.initial()[0]).max()))
                        fast = max(fast, float(np.abs(q).max()))
                    changes.append(worst)
                    moving.append(fast)
                found[room, slope, fill] = np.array(changes)
                still = sum(each == 0.0 for each in moving)
                rows.append([f"{100 * fill:.0f} %", slope, room, *changes, f"{still} of {len(NOISES)}"])
    chapter.table(f"Largest change of h in {count} steps, by noise in h and u", (
        "filled", "zeta", "room", *(f"{noise:g}" for noise in NOISES), "stopped again"), rows)  # fmt: skip
    for slope in SLOPES:
        chapter.claim(f"hold, filled to 100 percent, zeta = {slope}: change of h over the noise, up to 1e-6",
                      max(found["hold", slope, 1.0][:3] / NOISES[:3]), high=100.0)  # fmt: skip
    at = NOISES.index(1e-8)
    for slope, least in (("delta/2", 1e-5), ("2 delta", 1e-3)):
        chapter.claim(f"reflect, filled to 100 percent, zeta = {slope}, noise of 1e-8: change of h",
                      found["reflect", slope, 1.0][at], low=least)  # fmt: skip
    for room in ROOMS:
        chapter.claim(f"{room}, filled to 80 percent, zeta = delta/2: change of h over the noise, up to 1e-6",
                      max(found[room, "delta/2", 0.8][:3] / NOISES[:3]), high=100.0)  # fmt: skip
    return found


def accuracy(chapter: Chapter) -> None:
    """Exact solutions that rest somewhere or start, and the silo's front at rest."""
    rows = []
    for name in ("wedge that stops", "dam on a wet bed", "dam on dry ground", "cap"):
        case = CASES[name]
        errors = case.errors([*ROOMS.values()] * 2, Courant(0.9, case.end), (280, 280, 560, 560))
        rows.append([name, *errors])
        chapter.claim(
            f"{name}: L1(h) of reflect over that of hold, dx = 0.025", errors[3] / errors[2], low=0.8, high=1.25
        )
    chapter.table("L1(h), Courant 0.9", ("", "hold, dx = 0.05", "reflect", "hold, dx = 0.025", "reflect"), rows)
    scene, _, _ = load_scene("silo")
    fronts = []
    for count in (320, 640, 1280)[: 3 if chapter.full else 2]:
        for room, method in ROOMS.items():
            finer = replace(scene, cells=replace(scene.cells, count=count))
            one = simulate(finer, method, Courant(0.9, 10.0), 10**6)
            h_at = front(one.x, one.h[-1])
            if room == "hold":
                chapter.claim(f"silo, dx = {16 / count:g}, hold: front at rest less that of the prototype",
                              h_at - PROTOTYPE[count], low=-0.03, high=0.03)  # fmt: skip
            fronts.append([room, 16 / count, h_at, float(np.abs(one.q[-1]).max())])
    chapter.table("`silo`: front at rest", ("room", "dx", "front", "largest |q|"), fronts)
    for (_, dx, at, _), (_, _, other, _) in zip(fronts[::2], fronts[1::2], strict=True):
        chapter.claim(
            f"silo, dx = {dx:g}: front of reflect less that of hold, in cells", abs(other - at) / dx, high=1.5
        )


def front(x: Array, h: Array, bed: float = 0.3) -> float:
    """Where the height comes down to 1.01 times that of the bed, on the right."""
    k = int(np.flatnonzero(h > 1.01 * bed)[-1])
    share = (h[k] - 1.01 * bed) / max(h[k] - h[k + 1], 1e-300)
    return float(x[k] + share * (x[k + 1] - x[k]))


def creeping(chapter: Chapter) -> None:
    """A column breaks on dry ground between walls: when |q| is 0 exactly, and how far it came."""
    x, rows = (np.arange(96) + 0.5) / 96, []
    for zeta in (0.0, 0.15, -0.25):
        scene = scene_of(np.where(np.abs(x - 0.5) < 0.15, 1.0, 0.0), zeta=zeta, delta=DELTA, dx=0.05)
        for room, method in ROOMS.items():
            one = simulate(scene, method, Courant(0.9, 40.0), 5)
            moving = np.flatnonzero((one.q != 0).any(axis=1))
            last = float(one.t[moving[-1]]) if moving.size else 0.0
            rows.append([zeta, room, last, float((one.h[-1] > 0).sum() * scene.cells.dx),
                         float((one.h[-1] > 1e-3).sum() * scene.cells.dx)])  # fmt: skip
            chapter.claim(f"column on dry ground, zeta = {zeta}, {room}: largest |q| at the end",
                          np.abs(one.q[-1]).max(), high=0.0)  # fmt: skip
    chapter.table("A column on dry ground between walls", (
        "zeta", "room", "last motion, t", "length of what is wet", "... of h > 0.001"), rows)  # fmt: skip


def cost(chapter: Chapter) -> None:
    """Time per step of `silo`."""
    scene, _, _ = load_scene("silo")
    taken = {room: [] for room in ROOMS}
    for _ in range(5):
        for room, method in ROOMS.items():
            began = time.perf_counter()
            number = sum(1 for _ in steps(scene, method, *scene.initial(), 200, 0.9))
            taken[room].append((time.perf_counter() - began) / number)
    middle = {room: statistics.median(each) for room, each in taken.items()}
    chapter.table(
        "`silo`, 320 cells: microseconds per step, median of 5", tuple(middle), [[1e6 * x for x in middle.values()]]
    )
    chapter.claim("time per step of reflect over that of hold", middle["reflect"] / middle["hold"], low=0.2, high=5.0)


def draw(found: dict[tuple[str, str, float], Array]) -> Figure:
    """Change over noise, one panel per fill."""
    figure = Figure(figsize=(11, 4.4), layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    for axes, fill in zip(panels, (1.0, 0.8), strict=True):
        for number, slope in enumerate(SLOPES):
            for room, line in (("hold", "-"), ("reflect", "--")):
                axes.loglog(NOISES, np.maximum(found[room, slope, fill], 1e-13), line, color=COLOURS[number],
                            linewidth=1.6, marker=MARKS[number], markersize=5, label=f"{room}, zeta = {slope}",
                            markerfacecolor=COLOURS[number] if room == "hold" else "white")  # fmt: skip
        axes.loglog(NOISES, NOISES, color="0.6", linewidth=1, linestyle=":", label="the noise itself")
        axes.set_title(f"filled to {100 * fill:.0f} percent", loc="left", fontsize=10)
        axes.set_xlabel("noise in h and u")
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("largest change of h")
    panels[1].legend(frameon=False, fontsize=8, loc="upper left")
    return figure


if __name__ == "__main__":
    run(main, __doc__)
