"""Log-log pictures with a label at the end of each line."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Told apart by colour-blind readers, too (Okabe and Ito)."""

MARKS = "osD^vPX"


class Lines:
    """One axes with lines over n, labelled at their right ends without overlap."""

    def __init__(self, axes: Any, title: str, low: float, ticks: Sequence[int], what: str = "velocity nodes n") -> None:
        self.axes, self.low = axes, low
        self._ends: list[tuple[float, float, str, str]] = []
        axes.set_xscale("log", base=2)
        axes.set_yscale("log")
        axes.set_xticks(list(ticks), [str(n) for n in ticks])
        axes.minorticks_off()
        axes.set_title(title, loc="left", fontsize=10)
        axes.set_xlabel(what)
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)

    def line(self, nodes: Sequence[float], values: Sequence[float], label: str, number: int) -> None:
        """Add a line; what lies below `low` is drawn there, as nothing."""
        colour, shown = COLOURS[number % len(COLOURS)], np.maximum(values, self.low)
        style = {"marker": MARKS[number % len(MARKS)], "markersize": 4.5, "linewidth": 1.6}
        self.axes.plot(nodes, shown, color=colour, **style)
        self._ends.append((float(nodes[-1]), float(shown[-1]), label, colour))

    def level(self, value: float, label: str) -> None:
        """A grey level with its meaning."""
        if value > self.low:
            self.axes.axhline(value, color="0.6", linewidth=1, zorder=0)
            self.axes.annotate(
                label, (1, value), xycoords=("axes fraction", "data"), xytext=(-3, -4), textcoords="offset points",
                fontsize=8, color="0.4", ha="right", va="top",
            )  # fmt: skip

    def finish(self, gap: float = 0.062, room: float = 2.2) -> None:
        """Set limits and write the labels, `gap` of the height apart at least, each as near to its end as can be."""
        low, high = self.axes.get_ylim()
        low, high = max(low, self.low / 10), high * 1.5
        left, right = self.axes.get_xlim()
        self.axes.set(ylim=(low, high), xlim=(left, right * room))
        span = np.log(high / low)
        for x in {end[0] for end in self._ends}:
            ends = sorted((end for end in self._ends if end[0] == x), key=lambda end: end[1])
            wanted = [float(np.log(y / low) / span) for _, y, _, _ in ends]
            gaps = [0.5 * gap * (end[2].count("\n") + 1) for end in ends]
            for (_, y, label, colour), place in zip(ends, spread(wanted, gaps), strict=True):
                self.axes.annotate(
                    label, (x, y), xytext=(x * 1.12, low * np.exp(place * span)),
                    fontsize=8.5, color=colour, va="center",
                )  # fmt: skip


def spread(wanted: list[float], halves: list[float]) -> list[float]:
    """Places in [0, 1] near the ascending `wanted`, each with its half-width of room on both sides."""
    places = list(wanted)
    for _ in range(200):
        for k in range(len(places) - 1):
            short = halves[k] + halves[k + 1] - (places[k + 1] - places[k])
            if short > 0.0:
                places[k] -= 0.5 * short
                places[k + 1] += 0.5 * short
        places = [min(max(p, half), 1.0 - half) for p, half in zip(places, halves, strict=True)]
    return places
