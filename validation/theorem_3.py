"""Theorem 3: heights stay nonnegative up to Courant number 1 with the upwind flux, and not with the balanced one.

A cell that takes F at both walls keeps h - lam int |xi| M of what it had, which is at least 0 while lam |xi| <= 1 on
the support of M, and gains what its neighbours send. The theorem asks for |q| >= |dt g h^{n+1}|: cells that scheme 3
lets take F. Random states in which many cells sit on the bound, thin films and dry cells among them, show it for
scheme 1, for the fast cells of scheme 3 in both couplings, and for the density of the kinetic wing, node by node. Just
beyond the bound it fails: a thin, fast film in the void loses more than it has.

The paper expects the same of slow cells. They take F~, which lets a cell send half of what its neighbour holds: a film
of 0.001 beside a block that leaves at u = 2 goes negative at Courant number 0.058. By quadrature as by closed form.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from claims import Chapter, run
from laboratory.pictures import COLOURS
from matplotlib.figure import Figure
from numpy.typing import NDArray

from kinsim import Cells, ConstantSlope, Coulomb, Kinetic, Macroscopic, Profile, Scene, Uniform, step
from kinsim.measure.reference import by_quadrature

Array = NDArray[np.float64]
EPS = float(np.finfo(float).eps)
FASTEST = 2.0
"""max(|u| + c) of the random states."""
SCENE = Scene(Cells(0, 1, 4), Profile(np.ones(4)), ConstantSlope(0.2), Coulomb(0.1), boundary="periodic", epsilon=0.4)


def random_states(count: int, seed: int) -> tuple[Scene, Array, Array]:
    """Heights over ten decades, every seventh cell dry, half of the others with |u| + c on the bound."""
    dice = np.random.default_rng(seed)
    scene = replace(SCENE, cells=Cells(0.0, 0.05 * count, count), heap=Profile(np.ones(count)))
    h = 10.0 ** dice.uniform(-10, 0.5, count)
    c = np.sqrt(2.0 * scene.beta * h)
    share = np.where(dice.random(count) < 0.5, 1.0, dice.random(count))
    u = dice.choice([-1.0, 1.0], count) * share * (FASTEST - c) * (1.0 - 4.0 * EPS)
    dry = np.arange(count) % 7 == 0
    return scene, np.where(dry, 0.0, h), np.where(dry, 0.0, u)


def main(chapter: Chapter) -> None:
    """Random states below, at and beyond the bound; then the counterexample."""
    count = 200_000 if chapter.full else 20_000
    scene, h, u = random_states(count, 3)
    at = 0.999 * scene.cells.dx / FASTEST
    largest = float(h.max())
    methods = {"scheme 1": Macroscopic(1), "scheme 3": Macroscopic(3), "scheme 3, face": Macroscopic(3, "face")}
    rows = []
    for name, method in methods.items():
        now = step(scene, method, h, h * u, at)
        fast = ~now.slow if method.scheme == 3 else np.ones(count, dtype=bool)
        chapter.claim(f"{name}: least h of {count} random cells at Courant number 0.999, those with F",
                      now.h1[fast].min(), low=-EPS * largest)  # fmt: skip
        rows.append([name, int(fast.sum()), float(now.h1[fast].min()), int((~fast).sum()),
                     float(now.h1[~fast].min()) if (~fast).any() else "-"])  # fmt: skip
    few, hf, uf = random_states(2000, 4)
    coarse = step(few, Kinetic(1, Uniform(64, FASTEST)), hf, hf * uf, 0.999 * few.cells.dx / FASTEST)
    chapter.claim("kinetic wing, 2000 cells, 64 nodes: least f after transport", coarse.f_transport.min(),
                  low=-EPS * coarse.M.max())  # fmt: skip
    chapter.table(
        "Random states at Courant number 0.999", ("", "cells with F", "least h", "slow cells", "least h"), rows
    )

    courants = np.linspace(0.5, 1.2, 36)
    shares = np.array([least_share(scene, h, u, number) for number in courants])
    inside, beyond = courants <= 0.9999, courants >= 1.0101
    chapter.claim("scheme 1: least share of its height that a cell keeps below Courant number 1", shares[inside].min(),
                  low=-8 * EPS)  # fmt: skip
    chapter.claim(
        "scheme 1: share of its height that a cell keeps beyond Courant number 1.01, largest (the bound is sharp)",
        shares[beyond].max(),
        high=-1e-3,
    )
    slow, numbers = counterexample(chapter)
    chapter.figure(draw(courants, shares, numbers, slow), "bound",
                   "Least share of its height that a cell keeps in one step.")  # fmt: skip


def least_share(scene: Scene, h: Array, u: Array, number: float) -> float:
    """min h^{n+1}/h^n over wet cells of scheme 1 at a Courant number."""
    wet = h > 0
    h1 = step(scene, Macroscopic(1), h, h * u, number * scene.cells.dx / FASTEST).h1
    return float((h1[wet] / h[wet]).min())


def counterexample(chapter: Chapter) -> tuple[Array, Array]:
    """The film beside a block that leaves; returns the share the film's last cell keeps over Courant numbers."""
    h, u = np.array([0.001] * 3 + [1.0] * 3), np.array([0.0] * 3 + [2.0] * 3)
    scene = replace(SCENE, cells=Cells(0, 0.3, 6), chute=ConstantSlope(0.0), friction=Coulomb(np.pi / 10),
                    boundary="open", heap=Profile(h, u))  # fmt: skip
    dt, dx, beta = 1e-3, scene.cells.dx, scene.beta
    courant = (2.0 + np.sqrt(2 * beta)) * dt / dx
    chapter.claim("counterexample: its Courant number", courant, low=0.0575, high=0.0585)
    mean = 0.5 * (h[1:4] + h[2:5])[:2]  # at both walls of cell 2
    F1, _ = by_quadrature((mean, u[1:3], mean, u[2:4]), beta)
    foreseen = h[2] - dt / dx * (F1[1] - F1[0])
    rows = []
    for name, method in {
        "scheme 1": Macroscopic(1), "scheme 2": Macroscopic(2), "scheme 3": Macroscopic(3),
        "scheme 3, face": Macroscopic(3, "face"), "scheme 3, kinetic, 256 nodes": Kinetic(3, Uniform(256)),
    }.items():  # fmt: skip
        now = step(scene, method, h, h * u, dt)
        rows.append([name, float(now.h1[2]), int(now.slow[2])])
        if method == Macroscopic(3):
            chapter.claim("counterexample, scheme 3: least h", now.h1.min(), high=-1e-4)
            chapter.claim(
                f"counterexample, {name}: least h less what quadrature of (25) gives",
                abs(now.h1[2] - foreseen),
                high=4 * EPS,
            )
        if method == Macroscopic(1) or method == Macroscopic(3, "face"):
            chapter.claim(f"counterexample, {name}: least h", now.h1.min(), low=0.0)
    chapter.table("h of the film's last cell after one step, from 0.001", ("", "h", "slow"), rows)
    numbers = np.linspace(0.002, 1.0, 60)
    steps = [step(scene, Macroscopic(3), h, h * u, n / courant * dt) for n in numbers]
    return np.array([now.h1[2] / h[2] for now in steps]), numbers


def draw(courants: Array, shares: Array, numbers: Array, slow: Array) -> Figure:
    """Left cells with F around the bound, right the slow film."""
    figure = Figure(figsize=(11, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    left.plot(courants, shares, color=COLOURS[0], marker="o", markersize=4, linewidth=1.5)
    left.axvline(1, color="0.6", linewidth=1)
    left.annotate("bound (28)", (1, 0.4), xytext=(5, 0), textcoords="offset points", fontsize=9, color="0.35")
    left.set_title("random cells with F: the worst of them", loc="left", fontsize=10)
    right.plot(numbers, slow, color=COLOURS[1], linewidth=1.8)
    right.plot([0.058], np.interp([0.058], numbers, slow), "D", color=COLOURS[1], markersize=6)
    right.annotate("Courant number 0.058", (0.058, np.interp(0.058, numbers, slow)), xytext=(8, 14),
                   textcoords="offset points", fontsize=9, va="center", color=COLOURS[1])  # fmt: skip
    right.set_ylim(-24, 4)
    right.set_title("a slow film beside a block that leaves: F~", loc="left", fontsize=10)
    for axes in (left, right):
        axes.axhline(0, color="0.6", linewidth=1)
        axes.set(xlabel=r"Courant number, max(|u| + c) $\Delta t/\Delta x$", ylabel=r"least $h^{n+1}/h^n$")
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


if __name__ == "__main__":
    run(main, __doc__)
