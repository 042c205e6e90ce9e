"""A run as a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..diagnostics.dump import LONG_NAMES
from ..errors import InputError
from ..exact.of_scene import exact_of
from ..film.reel import equilibrium, visible
from ..run import Run
from .bed import Bed, curved
from .picture import save

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CURVES = 6
"""States shown, the first and the last included."""


def plot_run(run: Run, path: str | Path) -> Path:
    """Draw `run` into a PNG, PDF or SVG file, all of it or nothing.

    Raises:
        InputError: The suffix is none of these, or the file cannot be put there.
    """
    return save(draw(run), path)


def draw(run: Run) -> Figure:
    """h and u at several times, and the density over (x, xi) at the end."""
    from matplotlib.figure import Figure

    chute = curved(run.scene)
    figure = Figure(figsize=(9, 13 if chute else 10), layout="constrained")
    ratios = (1.2, 1, 1, 1.3) if chute else (1, 1, 1.3)
    *bed, heights, velocities, phase = figure.subplots(len(ratios), 1, height_ratios=ratios)
    for axes in (heights, velocities):
        axes.sharex(phase)
        axes.tick_params(labelbottom=False)
    figure.suptitle(f"{run.scene.title or 'untitled'}: {run.method.kind}, scheme {run.method.scheme}")
    _curves(run, heights, velocities)
    for axes in bed:
        _on_the_bed(run, axes)
    image, what = _phase(run, phase)
    figure.colorbar(image, ax=phase, label=what, pad=0.01)
    phase.set_xlabel("x (all quantities dimensionless)")
    phase.set_xlim(run.scene.cells.left, run.scene.cells.right)
    return figure


def _curves(run: Run, heights: Any, velocities: Any) -> None:
    from matplotlib import colormaps

    rows = telling_rows(run.h, CURVES)
    colours = colormaps["viridis_r"](np.linspace(0.1, 1.0, len(rows)))
    exact = exact_of(run.scene)
    for row, colour in zip(rows, colours, strict=True):
        heights.plot(run.x, run.h[row], color=colour, label=f"t = {run.t[row]:.3g}")
        velocities.plot(run.x, visible(run.h[row], run.u[row]), color=colour)
        if exact is not None and row:
            _overlay(exact, run, row, heights, velocities, "exact" if row == rows[-1] else None)
    heights.set_ylabel("height h")
    heights.set_ylim(min(0.0, 1.05 * run.h.min()), 1.05 * run.h.max() or 1.0)
    velocities.set_ylabel("velocity u = q/h")
    for axes in (heights, velocities):
        axes.grid(alpha=0.3)
    entries = len(heights.get_legend_handles_labels()[1])
    heights.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=entries, frameon=False, columnspacing=1.2)


def _on_the_bed(run: Run, axes: Any) -> None:
    """The mass upon the chute, at the times of the curves."""
    from matplotlib import colormaps

    rows = telling_rows(run.h, CURVES)
    bed = Bed.of(run.scene, float(run.h.max()))
    bed.draw(axes)
    for row, colour in zip(rows, colormaps["viridis_r"](np.linspace(0.1, 1.0, len(rows))), strict=True):
        axes.fill(*bed.outline(np.maximum(run.h[row], 0.0)).T, color=colour, alpha=0.25, linewidth=0.0)
        axes.plot(*bed.surface(np.maximum(run.h[row], 0.0)), color=colour, linewidth=1.0)
    seen = ("lifted_from", "lifted_to", "lifted_since")
    begin, end, since = (float(run.entries.get(name, [np.nan])[-1]) for name in seen)
    if np.isfinite(begin):
        bed.mark(axes, run.scene, begin, end, f"left the ground here, first at t = {since:.3g}")
        axes.legend(loc="upper right", frameon=False)
    axes.set_title(f"on the chute, {bed.words}", fontsize="medium")


def _overlay(exact: Any, run: Run, row: int, heights: Any, velocities: Any, label: str | None) -> None:
    """The exact solution at a saved time, where it holds."""
    fine = np.linspace(run.scene.cells.left, run.scene.cells.right, 2001)
    try:
        h, u = exact(fine, float(run.t[row]))
    except InputError:
        return
    for axes, values in ((heights, h), (velocities, u)):
        axes.plot(fine, values, color="black", linewidth=0.8, linestyle="--", label=label if axes is heights else None)


def telling_rows(h: Array, count: int) -> list[int]:
    """`count` rows of h, shape (nt, nx), or fewer, first and last included, with about the same change in between."""
    change = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(h, axis=0)).sum(axis=1))])
    wanted = np.linspace(0.0, change[-1], count)
    between = np.searchsorted(change, wanted[1:-1])
    return sorted({0, *map(int, between), len(h) - 1})


def _phase(run: Run, axes: Any) -> tuple[Any, str]:
    h = np.maximum(run.h[-1], 0.0)
    u = visible(h, run.u[-1])
    c = np.sqrt(2.0 * run.scene.beta * h)
    low, high = min(0.0, float((u - c).min())), max(0.0, float((u + c).max()))
    span = (high - low) or 1.0
    low, high = low - 0.06 * span, high + 0.2 * span
    xi, f, what = _density(run, h, u, low, high)
    image = axes.pcolormesh(run.x, xi, f.T, cmap="viridis", shading="nearest", rasterized=True, vmin=0.0)
    axes.plot(run.x, u + c, color="white", linewidth=1.2, label="support edges u ± c")
    axes.plot(run.x, u - c, color="white", linewidth=1.2)
    axes.plot(run.x, u, color="white", linewidth=1.2, linestyle=":", label="mean velocity u")
    axes.set_facecolor(image.cmap(0.0))
    axes.set_ylim(low, high)
    axes.set_ylabel(r"particle velocity $\xi$")
    axes.legend(loc="upper right", ncols=2, facecolor=image.cmap(0.0), edgecolor="none", labelcolor="white")
    return image, what


def _density(run: Run, h: Array, u: Array, low: float, high: float) -> tuple[Array, Array, str]:
    """Nodes, the density at the end of the run on them, shape (nx, n), and what it is."""
    end = f"at t = {run.t[-1]:.3g}"
    for dump in run.dumps.values():
        if (
            dump.attrs["long_name"] == LONG_NAMES["force"]
            and dump.shape[1] == run.x.size
            and run.t[-1] in dump["t"].to_numpy()[-1:]
        ):
            return dump["xi"].to_numpy(), dump[-1].to_numpy(), rf"$f(x, \xi)$ after the force, {end}"
    xi = np.linspace(low, high, 401)
    return xi, equilibrium(h, u, run.scene.beta, xi), rf"equilibrium $M(h, \xi - u)$, {end}"
