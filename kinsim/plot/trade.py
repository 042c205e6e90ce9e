"""Cost against error, with the Pareto front, and the velocity error over the nodes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .picture import save

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

LOOKS = {
    "closed form": ("#000000", "*", 130), "cell average": ("#0072B2", "o", 30), "sampled": ("#D55E00", "s", 26),
    "fitted": ("#009E73", "D", 26), "force": ("#CC79A7", "v", 30), "dx": ("#E69F00", "P", 36),
    "courant": ("#56B4E9", "X", 36), "order": ("#7A5195", "^", 36),
}  # fmt: skip
"""By line; told apart by colour-blind readers, too (after Okabe and Ito). Any other line is grey."""

OTHER = ("#777777", "o", 30)
ORDERS = {"sampled": -1.5, "cell average": -2.0}
"""Of half-range fluxes in the number of nodes."""


ENOUGH = 0.1
"""A velocity error of this share of the error of dx and dt is ringed."""


def plot_trade(measured: xarray.Dataset, path: str | Path) -> Path:
    """Draw `kinsim.trade(...)`: total error against wall time, and velocity error against nodes.

    Raises:
        InputError: The picture cannot be put there.
    """
    return save(draw_trade(measured), path)


def draw_trade(measured: xarray.Dataset) -> Figure:
    """The figure of `plot_trade`."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 6.4), layout="constrained")
    costs, nodes = figure.subplots(1, 2)
    figure.suptitle(str(measured.attrs["title"]))
    _costs(measured, costs)
    _nodes(measured, nodes)
    for axes in (costs, nodes):
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _costs(measured: xarray.Dataset, axes: Any) -> None:
    line = measured["line"].to_numpy()
    time, error = measured["wall_time"].to_numpy(), measured["total_error"].to_numpy()
    low, high = (np.abs(measured[f"wall_time_{end}"].to_numpy() - time) for end in ("low", "high"))
    for name in dict.fromkeys(line.tolist()):
        colour, mark, size = LOOKS.get(name, OTHER)
        at = line == name
        axes.errorbar(time[at], error[at], xerr=(low[at], high[at]), fmt="none", ecolor=colour, alpha=0.4)
        axes.scatter(time[at], error[at], s=size, marker=mark, color=colour, label=_words(name), zorder=3)
    front = measured.isel(member=np.flatnonzero(measured["pareto"].to_numpy())).sortby("wall_time")
    axes.plot(
        front["wall_time"], front["total_error"], color="black", linewidth=1, label="Pareto front: none is better"
    )
    for one in np.flatnonzero(measured["knee"].to_numpy()):
        axes.scatter(time[one], error[one], s=260, facecolors="none", edgecolors="black", linewidths=1.6, zorder=4)
        axes.scatter([], [], s=90, facecolors="none", edgecolors="black", linewidths=1.6,
                     label=f"knee: {_short(measured.isel(member=one))}")  # fmt: skip
    axes.set_xlabel("wall time of the run in s, median and range")
    if (error > 0.0).any():
        axes.set(xscale="log", yscale="log")
    else:
        _nothing(axes, "no total errors")
    axes.set_ylabel("total error: L1(h) at the end / mass")
    axes.set_title(f"error against cost; judged by {measured.attrs['judge']}", loc="left", fontsize=10)
    _below(axes, 3)


def _nodes(measured: xarray.Dataset, axes: Any) -> None:
    line = measured["line"].to_numpy()
    total = measured["total_error"].to_numpy()
    closed, drawn = total[(line == "closed form") & (total > 0.0)], False
    for name in ("cell average", "sampled", "fitted"):
        of = measured.isel(member=np.flatnonzero((line == name) & (measured["velocity_error"].to_numpy() > 0.0)))
        if not of.sizes["member"]:
            continue
        drawn = True
        colour, mark, _ = LOOKS[name]
        n, error = of["nodes"].to_numpy(), of["velocity_error"].to_numpy()
        axes.plot(n, error, marker=mark, markersize=5, color=colour, label=f"{_words(name)}{_order(name, n, error)}")
        paid = np.flatnonzero(error <= ENOUGH * closed[0]) if closed.size else ()
        for one in paid[:1]:
            axes.scatter(n[one], error[one], s=150, facecolors="none", edgecolors=colour, linewidths=1.5, zorder=4)
        if name in ORDERS and n.size > 1:
            fair = np.exp(np.mean(np.log(error) - ORDERS[name] * np.log(n)))
            axes.plot(n, fair * n ** ORDERS[name], ":", color=colour, linewidth=1.2)
    if closed.size:
        axes.axhline(closed[0], color="black", linewidth=1)
        axes.annotate("error of dx and dt (closed form)", (0.01, closed[0]), (0, 4), xycoords=("axes fraction", "data"),
                      textcoords="offset points", fontsize=8.5)  # fmt: skip
    axes.set_xlabel("velocity nodes n")
    axes.set_ylabel("velocity error: L1(h) to the closed-form twin / mass")
    axes.set_title("what velocity nodes add", loc="left", fontsize=10)
    if closed.size or drawn:
        axes.set_yscale("log")
    if not drawn:
        _nothing(axes, "no velocity errors")
        axes.set_xticks([])
        if not closed.size:
            axes.set_yticks([])
        return
    axes.set_xscale("log", base=2)
    if closed.size:
        axes.scatter(
            [], [], s=90, facecolors="none", edgecolors="#777777", label="a tenth of dx and dt: more pay no more"
        )
    if set(ORDERS) & set(line.tolist()):
        axes.plot([], [], ":", color="#777777", label="orders of the fluxes")
    axes.xaxis.set_major_formatter("{x:g}")
    _below(axes, 2)


def _below(axes: Any, columns: int) -> None:
    """The legend where no point can be."""
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=columns, fontsize=8, frameon=False,
                columnspacing=1.2)  # fmt: skip


def _nothing(axes: Any, words: str) -> None:
    """A panel without points says so."""
    axes.text(0.5, 0.5, words, transform=axes.transAxes, ha="center", va="center", color="#777777")


def _order(name: str, n: np.ndarray, error: np.ndarray) -> str:
    """The order that was measured, beside that of the fluxes."""
    if n.size < 2:
        return ""
    if name not in ORDERS:
        return ": geometric"
    slope = np.polyfit(np.log(n), np.log(error), 1)[0]
    return f": n^{slope:.2f}, fluxes n^{ORDERS[name]:g}"


def _words(line: str) -> str:
    return {
        "cell average": "grid, cell averages", "sampled": "grid, sampled", "fitted": "fitted nodes",
        "force": "other forces, 64 nodes", "dx": "other dx, first order", "courant": "shorter steps",
        "order": "second order, all dx",
    }.get(line, line)  # fmt: skip


def _short(member: xarray.Dataset) -> str:
    nodes = f", {int(member['nodes'])} nodes" if int(member["nodes"]) else ""
    return f"order {int(member['order'])}, {int(member['cells'])} cells{nodes}"
