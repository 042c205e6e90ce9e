"""What a scene does not require is not paid for: forces, dry cells, nodes outside the support, cells that rest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from cases import Call, Case, Looked, Step
from grid import ratio
from rows import Row
from timing import interleave, same

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Frictionless,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    Uniform,
    Window,
)
from kinsim.solver.march import SWEPT

CELLS, NODES = 1000, 128
"""Of the scenes on a grid."""

RESTING = 20_000
"""Cells of the scenes that rest."""


class Pair(NamedTuple):
    """A scene that requires less, and one that requires all."""

    what: str
    less: Step
    all: Step


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this file."""
    rounds = 5 if quick else 15
    for pair in (*without_force(), *with_dry_cells(), *in_a_window()):
        yield compared(pair, rounds)
    for share, words in ((1.0, "nothing moves"), (0.5, "half moves")):
        yield at_rest(f"{words} / everything moves, closed form", share, Macroscopic(4), rounds)
        yield at_rest(f"{words} / everything moves, f not stored", share, Kinetic(4, Uniform(64, 2.0)), rounds)


def compared(pair: Pair, rounds: int) -> Row:
    """A row, after a look at whether both take the step that all stages define."""
    for step in pair[1:]:
        same(f"{pair.what}, stages", step.result(), step.of_stages())
    times = interleave({"less": pair.less, "all": pair.all}, rounds)
    less, more = times["less"], times["all"]
    return ratio(pair.what, less, more, None, f"{less.words(1e-6, 'us')}; {more.words(1e-6, 'us')}")


def without_force() -> Iterator[Pair]:
    """Flat ground without friction beside a slope with it."""
    for what, nx, kind in (("closed form, 1e4 cells", 10_000, Step), (f"carried f, {CELLS}x{NODES}", CELLS, Looked)):
        case = Case.dam(nx)
        flat = replace(case, scene=replace(case.scene, chute=ConstantSlope(0.0), friction=Frictionless()))
        method = case.on_grid(NODES) if kind is Looked else Macroscopic(1)
        yield Pair(f"no force / slope and friction, {what}", kind(flat, method), kind(case, method))


def with_dry_cells() -> Iterator[Pair]:
    """The middle of the dam alone beside the whole of it."""
    case = Case.dam(CELLS)
    x = case.scene.x
    method = case.on_grid(NODES)
    for share, words in ((0.5, "half"), (0.9, "nine tenths")):
        wet = np.abs(x) < (1.0 - share) * np.max(x)
        dry = replace(case, h=np.where(wet, case.h, 0.0), q=np.where(wet, case.q, 0.0))
        for how, kind in (("f not stored", Step), ("carried f", Looked)):
            yield Pair(f"{words} of the cells dry / all wet, {how}", kind(dry, method), kind(case, method))


def in_a_window() -> Iterator[Pair]:
    """A window that follows the support beside one with three times the nodes."""
    case = Case.dam(CELLS)
    wide = case.on_grid(3 * NODES)
    assert isinstance(wide.velocity, Uniform)
    wide = replace(wide, velocity=Uniform(3 * NODES, 3.0 * case.bound))
    follows = replace(wide, velocity=Window(2.0 * case.bound / NODES))
    for how, kind in (("f not stored", Step), ("carried f", Looked)):
        pair = Pair(f"window that follows / three times as wide, {how}", kind(case, follows), kind(case, wide))
        same(pair.what, pair.less.result()[:2], pair.all.result()[:2])
        yield pair


def at_rest(what: str, share: float, method: Kinetic | Macroscopic, rounds: int) -> Row:
    """Steps through a scene of which a share rests beside one that slides as a whole.

    The steps are so short that the mass stays where it is.
    """
    cells = Cells(-6.0, 6.0, RESTING)
    calls: dict[str, Call] = {}
    for name, at in (("less", share), ("all", 0.0)):
        slides = np.arange(RESTING) >= at * RESTING
        heap = Profile(1.0 + 0.1 * np.sin(cells.x), np.where(slides, 0.5, 0.0))
        scene = Scene(cells, heap, ConstantSlope(0.1), Coulomb(0.3), epsilon=0.4)
        h, q = scene.initial()
        case = Case(scene, h, q, 1e3 * cells.dx, 2.0)  # of which a step of `Step` is a billionth
        calls[name] = step = Step(case, method)
        for _ in range(20):
            step()
        swept = float(step.solver.seen[SWEPT]) / (step.solver.step * RESTING)
        if abs(swept - (1.0 - at)) > 0.05:
            raise AssertionError(f"{what}: {swept:.0%} of the cells were swept where {1.0 - at:.0%} move")
    times = interleave(calls, rounds)
    detail = "; ".join(time.words(1e-6, "us") for time in times.values())
    return ratio(what, times["less"], times["all"], 0.2 if share == 1.0 else None, detail)
