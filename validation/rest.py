"""Rest: Definition 1 and (22), what stays, what starts, what stops, and what (22) does not see.

A pile at rest is admissible if its slope lies within what friction can hold, |beta h_x - sin zeta| <= R. With the
balanced flux F~ and the force g~ of (22) such a pile stays as it is, to rounding; beyond the bound it starts with just
the excess, (26). Scheme 1 has no rest: from every step it takes the second difference of h^(3/2) that section 3.2
works out, and the peak of its parabola goes on sinking after scheme 3 has stopped.

On a velocity grid rest hangs on the second moment: F~ balances g~ only if the discrete M carries h u^2 + beta h^2/2.
M matched in three moments rests like the closed form, cell averages leave a small momentum.

(22) takes differences over two cells and is blind to zigzags. A zigzag far steeper than any friction holds rests for
ever; and a pile that (22) finds inside the bound slides away, from a breath of 1e-12, if a zigzag makes the mean height
at a cell too large.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from claims import Chapter, run
from laboratory.pictures import COLOURS, MARKS
from matplotlib.figure import Figure
from numpy.typing import NDArray

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Fixed,
    Kinetic,
    Macroscopic,
    Profile,
    Run,
    Scene,
    Uniform,
    load_scene,
    simulate,
    step,
)
from kinsim.exact import UniformSlide, coulomb_fill, random_pile

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)
DT = 1e-3
SEEDS = (1, 2, 3, 4, 5)


def ground(zeta: float = 0.1, delta: float = 0.4, cells: int = 40) -> Scene:
    """An incline that friction holds."""
    return Scene(
        Cells(0, 0.05 * cells, cells), Profile(np.ones(cells)), ConstantSlope(zeta), Coulomb(delta), epsilon=0.4
    )


def forces(scene: Scene) -> dict[str, float]:
    """What Definition 1 is about."""
    return {"pull": scene.chute.sin, "resistance": scene.resistance, "beta": scene.beta}


def pile(scene: Scene, fill: float, seed: int) -> Scene:
    """A random pile whose steepest face takes the share `fill` of what friction holds."""
    heap = random_pile(scene.cells, **forces(scene), fill=fill, per="face", rng=seed)
    return replace(scene, heap=heap)


def main(chapter: Chapter) -> None:
    """Steady states, starting, stopping, scheme 1, zigzags."""
    steps = 10_000 if chapter.full else 500
    fills = np.array([0.3, 0.6, 0.9, 1.0, 1.1, 1.3, 1.6])
    speeds = {
        name: np.array([[largest_u(method, fill, steps, seed) for seed in SEEDS] for fill in fills])
        for name, method in METHODS.items()
    }
    for name in ("scheme 2", "scheme 3", "scheme 3, face", "matched, 64 nodes"):
        inside = speeds[name][fills <= 0.9].max()
        chapter.claim(
            f"{name}: largest |u| in {steps} steps of {len(SEEDS)} piles inside the bound", inside, high=1e-14
        )
        chapter.claim(
            f"{name}: least of the largest |u| in {steps} steps of piles a tenth or more beyond the bound",
            speeds[name][fills > 1].min(),
            low=1e-5,
        )
    chapter.claim("cell averages, 64 nodes: largest |u| inside the bound", speeds["cell averages, 64 nodes"][:3].max(),
                  low=1e-8, high=2e-3)  # fmt: skip
    kept = [simulate(pile(ground(), 0.9, seed), Macroscopic(3), Fixed(DT, steps), steps).h for seed in SEEDS]
    chapter.claim("scheme 3: largest relative change of h inside the bound", max(
        np.abs(h[-1] / h[0] - 1).max() for h in kept), high=4 * EPS)  # fmt: skip
    start(chapter)
    stop(chapter)
    peaks = scheme_1(chapter)
    zigzag = blind(chapter)
    worst = {name: each.max(axis=1) for name, each in speeds.items()}
    chapter.figure(draw(fills, worst, peaks, zigzag), "rest", "What stays, what stops, and what (22) does not see.")


METHODS: dict[str, Macroscopic | Kinetic] = {
    "scheme 1": Macroscopic(1),
    "scheme 2": Macroscopic(2),
    "scheme 3": Macroscopic(3),
    "scheme 3, face": Macroscopic(3, "face"),
    "cell averages, 64 nodes": Kinetic(3, Uniform(64, 1.5), "cell-average"),
    "matched, 64 nodes": Kinetic(3, Uniform(64, 1.5), "matched"),
}


def waves(scene: Scene, fill: float, seed: int) -> Scene:
    """A random pile of four waves, without zigzags, whose slope (22) finds full to `fill`."""
    n, dice = scene.cells.count, np.random.default_rng(seed)
    x = np.arange(n - 1) / n
    w = sum(a * np.sin(2 * np.pi * (k * x + b)) for k, (a, b) in enumerate(dice.uniform(-1, 1, (4, 2)), start=1))
    w /= np.abs(w[1:] + w[:-1]).max() / 2
    h = np.concatenate(
        [[0.0], np.cumsum((scene.chute.sin + fill * scene.resistance * w) * scene.cells.dx / scene.beta)]
    )
    return replace(scene, heap=Profile(h - h.min() + 0.5))


def largest_u(method: Macroscopic | Kinetic, fill: float, steps: int, seed: int) -> float:
    """Largest |u| of a random pile of waves."""
    scene = waves(ground(), fill, seed)
    if isinstance(method, Kinetic):
        bound = 2.5 * np.sqrt(2 * scene.beta * scene.initial()[0].max())
        method = replace(method, velocity=Uniform(64, 1.2 * float(bound)))
    one = simulate(scene, method, Fixed(DT, steps), steps)
    return float(one.entries["u_max"].max())


def start(chapter: Chapter) -> None:
    """(26): the first step off the bound."""
    off, started, moved = zip(*(first_step(waves(ground(), 1.5, seed)) for seed in SEEDS), strict=True)
    chapter.claim("(26): q after the first step less dt (g~ - beta h_x) mean h, over dt", max(off), high=1e-13)
    chapter.claim("(26): cells that the first step starts, fewest of all piles", min(started), low=1)
    chapter.claim("(26): change of h in the first step, largest of all piles", max(moved), high=4 * EPS)


def first_step(scene: Scene) -> tuple[float, int, float]:
    """Departure of q from (26) over dt, number of cells beyond the bound, change of h."""
    h, q = scene.initial()
    now = step(scene, Macroscopic(3), h, q, DT)
    ghosted = np.pad(h, 1, mode="edge")
    slope = scene.beta * (ghosted[2:] - ghosted[:-2]) / (2 * scene.cells.dx)
    held = np.clip(slope, scene.chute.sin - scene.resistance, scene.chute.sin + scene.resistance)
    mean = 0.25 * (ghosted[2:] + 2 * h + ghosted[:-2])
    off = np.abs(now.q1 - DT * (held - slope) * mean).max() / DT
    return float(off), int((np.abs(held - slope) > 1e-12).sum()), float(np.abs(now.h1 - h).max())


def stop(chapter: Chapter) -> None:
    """A layer that slides out, against the exact solution; and a silo that stops on a slope friction holds."""
    base = replace(ground(), boundary="periodic")
    exact = UniformSlide(0.3, base.chute.sin, base.resistance)
    arrest = 0.3 / (base.resistance - base.chute.sin)
    one = simulate(replace(base, heap=Profile(np.ones(40), np.full(40, 0.3))), Macroscopic(3), Fixed(DT, 2000), 1)
    off = max(np.abs(one.u[row] - exact(one.x, t)[1]).max() for row, t in enumerate(one.t))
    rests = float(one.t[np.abs(one.u).max(axis=1) <= 1e-14][0])
    chapter.claim("sliding layer: |u - exact| at all times, over dt R", off / (DT * base.resistance), high=1.0)
    chapter.claim("sliding layer: time of rest less the exact one, over dt", (rests - arrest) / DT, low=-1.0, high=2.0)
    scene, _, clock = load_scene("silo")
    for method in (Macroscopic(2), Macroscopic(3), Macroscopic(3, "face")):
        end = simulate(scene, method, clock, clock.steps)
        fill = coulomb_fill(end.h[-1], scene.cells.dx, **forces(scene), per="cell")
        face = "" if method.coupling == "cell" else ", face"
        chapter.claim(
            f"silo, scheme {method.scheme}{face}: largest |q| at the end", np.abs(end.q[-1]).max(), high=1e-12
        )
        chapter.claim(
            f"silo, scheme {method.scheme}{face}: slope over what friction holds, (22)", fill, high=1.0 + 1e-9
        )


def scheme_1(chapter: Chapter) -> dict[str, Run]:
    """The erosion that section 3.2 works out, and a peak that keeps sinking."""
    scene = pile(ground(), 0.9, 1)
    h, q = scene.initial()
    lam, beta = DT / scene.cells.dx, scene.beta
    power = np.pad(h, 1, mode="edge") ** 1.5
    foreseen = lam * 2 / (3 * np.pi) * np.sqrt(2 * beta) * (power[2:] - 2 * power[1:-1] + power[:-2])
    found = step(scene, Macroscopic(1), h, q, DT).h1 - h
    chapter.claim("scheme 1: change of h at rest less the formula of 3.2", np.abs(found - foreseen).max(), high=8 * EPS)
    chapter.claim("scheme 1: change of h at rest in one step, largest", np.abs(found).max(), low=1e-5)
    cap, _, clock = load_scene("parabola")
    runs = {f"scheme {n}": simulate(cap, Macroscopic(n), clock, 100) for n in (1, 3)}
    late = {name: one.h[one.t >= 4].max(axis=1) for name, one in runs.items()}
    falls = -np.diff(late["scheme 1"])
    chapter.claim("parabola, scheme 1: least fall of the peak in 100 steps after t = 4", falls.min(), low=1e-6)
    chapter.claim("parabola, scheme 3: fall of the peak after t = 4, in all", np.ptp(late["scheme 3"]), high=1e-14)
    return runs


def blind(chapter: Chapter) -> dict[str, Run]:
    """A zigzag that rests although no friction could hold it, and one that unsettles a pile inside the bound."""
    flat = ground(0.0, 0.2)
    flat = replace(flat, boundary="periodic", heap=Profile(0.6 + 0.1 * (-1.0) ** np.arange(40)))
    h, _ = flat.initial()
    seen, true = (coulomb_fill(h, 0.05, **forces(flat), per=per) for per in ("cell", "face"))
    kept = simulate(flat, Macroscopic(2), Fixed(DT, 2000), 500)
    chapter.claim("zigzag of 0.1: slope over what friction holds, face by face", true, low=5.0)
    chapter.claim(
        "zigzag of 0.1: largest difference of heights over two cells, which is all that (22) sees",
        np.abs(h[2:] - h[:-2]).max(),
        high=EPS,
    )
    chapter.claim("zigzag of 0.1, scheme 2: largest |u| in 2000 steps", kept.entries["u_max"].max(), high=0.0)
    chapter.table("Zigzag of 0.1: largest slope over what friction holds", ("per face", "per cell, ends included"),
                  [[true, seen]])  # fmt: skip
    runs = {}
    for name, size in (("smooth", 0.0), ("with a zigzag of 0.02", 0.02)):
        scene = ground(0.0, 0.3)
        x = scene.x
        h = 0.3 + 0.95 * scene.resistance / scene.beta * np.minimum(x, x[::-1]) + size * (-1.0) ** np.arange(40)
        breath = 1e-12 * np.random.default_rng(1).uniform(-1, 1, 40)  # rounding alone may or may not wake the pile
        runs[name] = simulate(replace(scene, heap=Profile(h, breath)), Macroscopic(2), Fixed(DT, 4000), 40)
        slope = scene.beta * np.abs(h[2:] - h[:-2]).max() / (0.1 * scene.resistance)
        chapter.claim(f"pile filled to 95 percent, {name}: slope over what friction holds, (22)", slope, high=0.951)
    largest = {name: float(np.abs(one.u[-1]).max()) for name, one in runs.items()}
    chapter.claim(
        "pile filled to 95 percent, smooth: largest |u| 4000 steps after a breath of 1e-12",
        largest["smooth"],
        high=1e-14,
    )
    chapter.claim(
        "pile filled to 95 percent, with a zigzag of 0.02: largest |u| 4000 steps after a breath of 1e-12",
        largest["with a zigzag of 0.02"],
        low=1e-4,
    )
    return runs


def draw(fills: Array, speeds: dict[str, Array], peaks: dict[str, Run], zigzag: dict[str, Run]) -> Figure:
    """Piles by how full they are, peaks over time, the unsettled pile."""
    figure = Figure(figsize=(14, 4.4), layout="constrained")
    one, two, three = figure.subplots(1, 3)
    for number, (name, values) in enumerate(speeds.items()):
        one.semilogy(fills, np.maximum(values, 1e-18), color=COLOURS[number], marker=MARKS[number], markersize=5,
                     linewidth=1.4, label=name)  # fmt: skip
    one.axvline(1, ymax=0.8, color="0.6", linewidth=1)
    one.set_title("five random piles: largest |u|", loc="left", fontsize=10)
    one.set(xlabel="steepest slope over what friction holds", ylim=(1e-19, 1e5))
    one.legend(frameon=False, fontsize=8, ncols=2, loc="upper left")
    for number, (name, run_) in enumerate(peaks.items()):
        two.plot(
            run_.t, run_.h.max(axis=1), color=COLOURS[number], linestyle=("-", "--")[number], linewidth=1.8, label=name
        )
    two.set_title("parabola: scheme 1 never rests", loc="left", fontsize=10)
    two.set(xlabel="t (dimensionless)", ylabel="height of the peak", ylim=(0, 1.05))
    two.legend(frameon=False)
    for number, (name, run_) in enumerate(zigzag.items()):
        three.semilogy(run_.t, np.maximum(np.abs(run_.u).max(axis=1), 1e-18), color=COLOURS[number], label=name,
                       linestyle=("-", "--")[number], linewidth=1.8)  # fmt: skip
    three.set_title("a pile that (22) finds 95 percent full: largest |u|", loc="left", fontsize=10)
    three.set(xlabel="t (dimensionless)", ylim=(1e-19, 1e2))
    three.legend(frameon=False, loc="upper left")
    for axes in (one, two, three):
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


if __name__ == "__main__":
    run(main, __doc__)
