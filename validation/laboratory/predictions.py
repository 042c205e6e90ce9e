"""Predicted against measured, as a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from laboratory.pictures import COLOURS, MARKS


def draw(told: np.ndarray, found: np.ndarray, family: Mapping[str, Sequence[object]]) -> Figure:
    """Points above the line are bounds; columns in the order of the family's members."""
    figure = Figure(figsize=(7.5, 6), layout="constrained")
    axes = figure.subplots()
    first = 0
    for number, (name, methods) in enumerate(family.items()):
        at = slice(first, first + len(methods))
        axes.loglog(found[:, at].ravel(), told[:, at].ravel(), MARKS[number], color=COLOURS[number], markersize=4,
                    alpha=0.7, label=name)  # fmt: skip
        first += len(methods)
    ended = found[np.isfinite(found)]
    ends = np.array([ended.min(), ended.max()])
    axes.plot(ends, ends, color="black", linewidth=1, label="predicted = measured")
    axes.fill_between(ends, ends, 10 * ends, color="black", alpha=0.07, label="a bound, by less than 10")
    axes.set(xlabel="velocity error measured on the full run", ylabel="predicted from pilot runs")
    axes.legend(frameon=False)
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    return figure
