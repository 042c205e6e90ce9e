"""The map of an atlas: a line of marks for each axis, a field of them for each plane."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..stability.judge import CLASSES, Class
from .picture import save

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

LOOKS: dict[Class, tuple[str, str]] = {
    "exact": ("#0072B2", "D"),
    "stable": ("#56B4E9", "o"),
    "repaired": ("#F0E442", "s"),
    "oscillating": ("#D55E00", "X"),
    "refused": ("#BBBBBB", "_"),
    "non-finite": ("#000000", "*"),
}
"""Colour and mark; they can be told apart without colour, and by the colour-blind."""


def plot_atlas(found: xarray.Dataset, path: str | Path) -> Path:
    """Draw the atlas.

    Raises:
        InputError: The picture cannot be put there.
    """
    return save(draw_atlas(found), path)


def draw_atlas(found: xarray.Dataset) -> Figure:
    """The figure of `plot_atlas`."""
    from matplotlib.figure import Figure

    columns = {name: found[name].to_numpy() for name in ("axis", "across", "value", "across_value", "class")}
    maps = list(dict.fromkeys(zip(columns["axis"].tolist(), columns["across"].tolist(), strict=True)))
    sizes = [1.0 if not across else 0.3 * _count(columns, one, across) for one, across in maps]
    figure = Figure(figsize=(10.0, 0.85 * sum(sizes) + 1.4), layout="constrained")
    all_axes = np.atleast_1d(figure.subplots(len(maps), 1, height_ratios=sizes))
    figure.suptitle(f"{found.attrs['method']}", fontsize="medium")
    for (one, across), axes in zip(maps, all_axes, strict=True):
        at = (columns["axis"] == one) & (columns["across"] == across)
        _line(axes, {name: column[at] for name, column in columns.items()}, one, across)
        if one == "courant":
            _limit(axes, columns["value"][at], 1.0)
    handles = [
        all_axes[0].scatter([], [], color=colour, marker=mark, edgecolor="black", linewidth=0.5, label=word)
        if mark != "_"
        else all_axes[0].scatter([], [], color=colour, marker=mark, label=word)
        for word, (colour, mark) in LOOKS.items()
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(CLASSES), frameon=False)
    return figure


def _count(columns: dict[str, Any], one: str, across: str) -> int:
    at = (columns["axis"] == one) & (columns["across"] == across)
    return len(set(columns["across_value"][at].tolist()))


def _line(axes: Any, columns: dict[str, Any], one: str, across: str) -> None:
    """Marks at the places of the values, one row or a field."""
    values = list(dict.fromkeys(columns["value"].tolist()))
    others = list(dict.fromkeys(columns["across_value"].tolist()))
    for word, (colour, mark) in LOOKS.items():
        at = columns["class"] == word
        x = [values.index(value) for value in columns["value"][at]]
        y = [others.index(value) for value in columns["across_value"][at]]
        edge = {} if mark == "_" else {"edgecolor": "black", "linewidth": 0.5}
        axes.scatter(x, y, c=colour, marker=mark, s=60, **edge)
    axes.set_xticks(range(len(values)), values, fontsize="x-small")
    axes.set_yticks(range(len(others)) if across else [], others if across else [], fontsize="x-small")
    axes.set_ylabel(one if not across else f"{across} over {one}", rotation=0 if not across else 90,
                    ha="right" if not across else "center", va="center", fontsize="small")  # fmt: skip
    axes.set_xlim(-0.6, max(len(values) - 0.4, 15.6))
    axes.set_ylim(-0.6, len(others) - 0.4)
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)


def _limit(axes: Any, values: Any, limit: float) -> None:
    """A line where theory has the limit."""
    beyond = [number for number, value in enumerate(dict.fromkeys(values.tolist())) if float(value) > limit]
    if beyond:
        axes.axvline(beyond[0] - 0.5, color="black", linestyle="--", linewidth=1.0)
        place = axes.get_xaxis_transform()
        axes.text(beyond[0] - 0.45, 1.0, f"limit {limit:g}", fontsize="x-small", va="bottom", transform=place)
