"""Observed orders, and log-log pictures of errors with the slopes that they are held against."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from laboratory.pictures import COLOURS, MARKS


def order(widths: ArrayLike, errors: ArrayLike) -> float:
    """Slope of log |error| over log width, by least squares."""
    return float(np.polyfit(np.log(widths), np.log(np.maximum(np.abs(errors), 1e-300)), 1)[0])


def falls(widths: Sequence[float], errors: Sequence[float]) -> list[str]:
    """The order between neighbours, in words."""
    slopes = np.diff(np.log(np.maximum(np.abs(errors), 1e-300))) / np.diff(np.log(widths))
    return [f"{slope:.2f}" for slope in slopes]


@dataclass(frozen=True)
class Panel:
    """One pair of axes: errors over widths, a line per name."""

    title: str
    widths: Sequence[float]
    lines: Mapping[str, Sequence[float]]


def picture(rows: Sequence[Sequence[Panel]], width: str, error: str, powers: Sequence[float]) -> Figure:
    """Rows of panels with common axes; grey lines have the slopes `powers`, a name one colour and mark throughout."""
    names = list(dict.fromkeys(name for row in rows for panel in row for name in panel.lines))
    figure = Figure(figsize=(3.1 * len(rows[0]) + 2.2, 3.0 * len(rows) + 0.5), layout="constrained")
    grid = figure.subplots(len(rows), len(rows[0]), sharex=True, sharey=True, squeeze=False)
    for axes, panel in zip(grid.flat, (panel for row in rows for panel in row), strict=True):
        for name, errors in panel.lines.items():
            number = names.index(name)
            shift = number + number // len(COLOURS)  # beyond the colours, other marks tell lines apart
            axes.loglog(
                panel.widths, np.abs(errors), color=COLOURS[number % len(COLOURS)], marker=MARKS[shift % len(MARKS)],
                markersize=4.5, linewidth=1.4, linestyle="-" if number < len(COLOURS) else "--", label=name,
            )  # fmt: skip
        axes.set_title(panel.title, loc="left", fontsize=10)
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    low, high = grid.flat[0].get_ylim()
    for axes in grid.flat:
        ends = np.array(axes.get_xlim())
        for power in powers:
            top = 0.5 * high * (ends / ends.max()) ** power
            axes.loglog(ends, top, color="0.7", linewidth=1, linestyle=_DASHES[power], label=f"order {power:g}")
        axes.set(xlim=ends, ylim=(low, high))
        axes.minorticks_off()
    widths = sorted({each for row in rows for panel in row for each in panel.widths})
    grid.flat[0].set_xticks(widths, [f"{each:.3g}" for each in widths])  # the axes are common
    for axes in grid.flat:
        axes.tick_params(axis="x", labelsize=8, labelrotation=45)
    for axes in grid[-1]:
        axes.set_xlabel(width)
    for axes in grid[:, 0]:
        axes.set_ylabel(error)
    entries: dict[str, object] = {}
    for axes in grid.flat:
        entries |= dict(zip(*reversed(axes.get_legend_handles_labels()), strict=True))
    entries = dict(sorted(entries.items(), key=lambda entry: entry[0] not in names))  # slopes last
    figure.legend(list(entries.values()), list(entries), frameon=False, fontsize=9, loc="outside right center")
    return figure


_DASHES = {0.5: "--", 1.0: ":", 1.5: "-", 2.0: "-.", 2.5: (0, (5, 1, 1, 1)), 3.0: (0, (8, 3))}


def halvings(first: int, count: int) -> list[int]:
    """`count` numbers of cells, nodes or steps from `first`, each twice the one before."""
    return [first * 2**level for level in range(count)]
