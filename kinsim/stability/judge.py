"""What became of a run: measured, and said in one of six words."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np

from ..arrays import Array
from ..measure.entropy import of_state
from ..model.ground import flat
from ..run import ENDED
from ..scene import Scene
from .setting import Setting

Class = Literal["exact", "stable", "repaired", "oscillating", "refused", "non-finite"]

CLASSES: dict[Class, str] = {
    "exact": "nothing had to change, and not a bit did",
    "stable": "bounded, and within all measures below",
    "repaired": "stable, with a repair in the books: a window that cut, mass made at faces, a fallback of M",
    "oscillating": "energy rises, noise grows, h zigzags, steps shrink, heights fall below 0, or mass goes unbooked",
    "refused": "not computed, or stopped, with a reason",
    "non-finite": "stopped at a number that is none",
}

RISE = 1e-3
"""Energy, that of place included, may rise by this share of itself, beyond what a fall by one cell sets free."""

GROWTH = 1e5
"""So many times a disturbance of 1e-9 may grow: to 1e-4 of the highest mass. Shocks and few nodes let it grow some."""

BELOW = 1e-12
"""Heights may fall below 0 by this share of the highest one."""

BOOKED = 1e-12
"""Books that differ from 0 by less than this share of the mass are rounding."""

UNBOOKED = 1e-9
"""So much of the mass may come or go without being booked: rounding."""

TEETH = 0.5
"""So much of its height may the mass go up and down from cell to cell: a spike of one cell does by 1, one that stands
at a wall, into which a fast mass piles up, by 1/4."""

MEASURES = ("drift", "least", "rise", "growth", "variation", "zigzag")


def judge(
    setting: Callable[[], Setting], run: Mapping[str, Any], nudged: Mapping[str, Any]
) -> tuple[Class, dict[str, float]]:
    """The word for a run, and what was measured.

    Args:
        setting: Gives what was run.
        run: Its verdict_kind, mass_drift, ledger columns at the end, history_h and history_q, shape (nt, nx).
        nudged: Of the same with a disturbed start and the same steps.

    Returns:
        The word; and drift: |relative change of mass|, least: the lowest over the highest height, rise: the largest
        rise of energy over all energy, growth: of the disturbance, variation: total variation of h at the end over
        that at the start, which rises where a mass piles up and so is not judged, zigzag: the part of it, over the
        highest height, that is up and down from cell to cell, at its largest. NaN where nothing was run.
    """
    unknown = dict.fromkeys(MEASURES, math.nan)
    kind = run["verdict_kind"]
    if kind in ("refused", "cfl-broken", "window-too-small"):
        return "refused", unknown
    if kind not in (*ENDED, "too-many-steps"):
        return "non-finite", unknown
    h, q, other = run["history_h"], run["history_q"], nudged.get("history_h", np.full((1, 1), math.nan))
    scene = setting().scene
    highest = float(h.max())
    found = {
        "drift": abs(run["mass_drift"]),
        "least": float(h.min()) / highest if highest > 0.0 else 0.0,
        "rise": rise(scene, h, q),
        "growth": growth(h, other),
        "variation": float(np.abs(np.diff(h[-1])).sum() / (np.abs(np.diff(h[0])).sum() or 1.0)),
        "zigzag": zigzag(h),
    }
    mass = float(h[0].sum()) * scene.cells.dx
    booked = sum(abs(run.get(name, 0.0)) for name in ("window_loss", "coupling_drift", "mended"))
    unbooked = found["drift"] > UNBOOKED and not found["drift"] * mass <= booked * (1.0 + UNBOOKED)
    if kind in ENDED and nudged["verdict_kind"] not in ENDED:  # noise of 1e-9 stopped it
        found["growth"] = math.inf
    calm = found["rise"] <= RISE and found["growth"] <= GROWTH and found["least"] >= -BELOW
    calm &= found["zigzag"] <= TEETH
    if kind == "too-many-steps" or unbooked or not calm:
        return "oscillating", found
    if np.array_equal(h[0], h[-1]) and np.array_equal(q[0], q[-1]):
        return "exact", found
    if booked > BOOKED * mass or run.get("fallbacks", 0.0) > 0.0:
        return "repaired", found
    return "stable", found


def rise(scene: Scene, h: Array, q: Array) -> float:
    """The largest rise of int (h u^2/2 + beta h^2/2 - s x h) dx over its largest size, along the rows.

    Where in its cell a grain is nobody knows, so that a fall by dx is taken off.
    """
    unit = float(np.max(h)) or 1.0
    h, x = h / unit, scene.x
    pull = flat(scene.ground).pull
    place = pull * (x.max() - x if pull > 0 else x.min() - x) * h
    energy = (of_state(h, q / unit, flat(scene.ground).beta * unit) + place).sum(axis=1)
    size = float(np.abs(energy).max())
    unknown = abs(pull) * scene.cells.dx * float(h[0].sum())
    most = float(np.max(energy - np.minimum.accumulate(energy)))
    return max(most - unknown, 0.0) / size if size > 0.0 else 0.0


def zigzag(h: Array) -> float:
    """How much more of the total variation of h over its highest than at the start is up and down from cell to cell.

    That is what a mean over a cell and its neighbours, with weights 1/4, 1/2, 1/4, takes away: all of a wave of two
    cells, nothing of what rises or falls for long.
    """
    unit = float(np.max(h)) or 1.0
    wide = np.pad(h / unit, ((0, 0), (1, 1)), mode="edge")
    calm = 0.25 * (wide[:, :-2] + wide[:, 2:]) + 0.5 * wide[:, 1:-1]
    teeth = np.abs(np.diff(h / unit)).sum(axis=1) - np.abs(np.diff(calm)).sum(axis=1)
    return float(np.max(teeth - teeth[0]))


def growth(h: Array, other: Array) -> float:
    """How many times the largest difference of two runs with the same steps is that of their starts."""
    if other.shape[1] != h.shape[1]:
        return math.inf
    unit = float(np.max(h)) or 1.0
    apart = [float(np.max(np.abs(a / unit - b / unit))) for a, b in zip(h, other, strict=False)]
    return max(apart) / apart[0] if apart[0] > 0.0 else 0.0
