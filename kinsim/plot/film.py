"""The frames of a film: the density over (x, xi) on the left, height and velocity on the right."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..diagnostics.lift import normal_force
from ..film.reel import Reel, equilibrium, visible
from ..model.ground import Smooth
from .bed import LIFTED, Bed, curved

SIZES = {True: (9.0, 4.4), False: (5.6, 4.4)}
"""Width and height in inches of letters 10 points high, with a density and without."""

BED = 2.6
"""Inches that a chute takes."""

LINES = 300
"""Velocities at which a frame shows the density."""

OWN, TWIN = {"color": "#0072b2", "linewidth": 1.8}, {"color": "#d55e00", "linewidth": 1.4, "linestyle": (0, (3, 2))}
"""Okabe and Ito's colours for the colour-blind; dashes tell them apart without colour."""


class Pictures(Sequence[NDArray[np.uint8]]):
    """The frames of `reel`, each drawn when it is asked for: `width` pixels wide, of shape (height, width, 3)."""

    def __init__(self, reel: Reel, width: int) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        across, down = SIZES[reel.kinetic]
        chute = curved(reel.scene)
        down += BED * chute
        dpi = width / across
        figure = Figure(figsize=(across, round(down * dpi) / dpi), dpi=dpi, layout="constrained")
        canvas: Any = FigureCanvasAgg(figure)
        self._canvas = canvas
        times = [f"{time:.{_decimals(reel.t[-1])}f}" for time in reel.t]
        self._titles = [f"t = {time:>{len(times[-1])}}   {reel.title}" for time in times]
        self._title = figure.suptitle(self._titles[-1], x=0.01, ha="left", fontsize="medium")
        figures: Any = figure
        if chute:
            parts: Any = figure.subfigures(2, 1, height_ratios=(BED, down - BED))
            top, figures = parts
        grid = figures.add_gridspec(2, 2 if reel.kinetic else 1, width_ratios=(1.25, 1.0) if reel.kinetic else None)
        curves = _Curves(reel, figures.add_subplot(grid[0, -1]), figures.add_subplot(grid[1, -1]))
        self._parts: list[Any] = [curves, *([_Phase(reel, figures, grid)] if reel.kinetic else [])]
        if chute:
            self._parts.append(_OnTheBed(reel, top.subplots()))
        self._moving = [self._title, *(artist for part in self._parts for artist in part.moving)]
        for artist in self._moving:
            artist.set_animated(True)
        canvas.draw()
        self._still = canvas.copy_from_bbox(figure.bbox)

    def __len__(self) -> int:
        return len(self._titles)

    def __getitem__(self, row: Any) -> Any:
        if isinstance(row, slice):
            return [self[one] for one in range(*row.indices(len(self)))]
        self._title.set_text(self._titles[row])
        for part in self._parts:
            part.show(row)
        self._canvas.restore_region(self._still)
        for artist in self._moving:
            self._canvas.figure.draw_artist(artist)
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()


class _OnTheBed:
    """The mass upon the chute."""

    def __init__(self, reel: Reel, axes: Any) -> None:
        self._h = np.maximum(reel.h, 0.0)
        self._bed = Bed.of(reel.scene, float(self._h.max()))
        self._bed.draw(axes)
        axes.set_title(f"on the chute, {self._bed.words}", fontsize="small")
        for row in (0, -1):  # so that the axes leave room for both
            axes.update_datalim(self._bed.outline(self._h[row]))
        self._mass = axes.fill(*self._bed.outline(self._h[0]).T, color=OWN["color"], alpha=0.6, linewidth=0.8)[0]
        self._ground, self._q = reel.scene.ground, self._h * reel.u
        self._off = axes.plot([], [], label="off the ground", **LIFTED)[0]
        self.moving = [self._mass, self._off]
        if isinstance(self._ground, Smooth) and self._ground.bends:
            axes.legend(loc="upper right", frameon=False, fontsize="small")

    def show(self, row: int) -> None:
        self._mass.set_xy(self._bed.outline(self._h[row]))
        if isinstance(self._ground, Smooth):
            thick, normal = normal_force(self._ground, self._h[row], self._q[row])
            cells = np.pad(thick & (normal < 0.0), 1)
            off = cells[1:] | cells[:-1]  # the faces of such a cell
            self._off.set_data(np.where(off, self._bed.across, np.nan), np.where(off, self._bed.down, np.nan))


class _Curves:
    """h and u, and those of the twin."""

    def __init__(self, reel: Reel, heights: Any, velocities: Any) -> None:
        twin = reel.twin or (None, None)
        self._lines = []
        for axes, own, other in (
            (heights, reel.h, twin[0]),
            (velocities, visible(reel.h, reel.u), visible(*twin) if reel.twin else None),
        ):
            names = ("kinetic" if reel.kinetic else "closed form", "closed-form twin")
            for values, style, name in ((own, OWN, names[0]), (other, TWIN, names[1])):
                if values is not None:
                    self._lines.append((axes.plot(reel.scene.x, values[0], label=name, **style)[0], values))
            axes.grid(alpha=0.3)
            axes.set_xlim(reel.scene.cells.left, reel.scene.cells.right)
            axes.set_ylim(*_span(own, other))
        heights.set_ylabel("height h")
        heights.tick_params(labelbottom=False)
        velocities.set_ylabel("velocity u = q/h")
        velocities.set_xlabel("x (all quantities dimensionless)")
        if reel.twin:
            heights.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, fontsize="small")

        self.moving = [line for line, _ in self._lines]

    def show(self, row: int) -> None:
        for line, values in self._lines:
            line.set_ydata(values[row])


class _Phase:
    """The density over (x, xi) with the edges of its support."""

    def __init__(self, reel: Reel, figure: Any, grid: Any) -> None:
        self._reel = reel
        self._c = np.sqrt(2.0 * reel.scene.beta * np.maximum(reel.h, 0.0))
        self._u = visible(reel.h, reel.u)
        low, high = _span(self._u - self._c, self._u + self._c)
        if reel.density is not None:
            half = 0.5 * _width(reel.density.xi)
            low = max(low, float(reel.density.xi[0] + reel.density.offset.min()) - half)
            high = min(high, float(reel.density.xi[-1] + reel.density.offset.max()) + half)
        self._xi = low + (np.arange(LINES) + 0.5) * (high - low) / LINES
        axes = figure.add_subplot(grid[:, 0])
        ends = (reel.scene.cells.left, reel.scene.cells.right)
        self._image = axes.imshow(
            np.zeros((LINES, reel.h.shape[1])), origin="lower", aspect="auto", extent=(*ends, low, high),
            cmap="viridis", vmin=0.0, vmax=self._largest(), interpolation="nearest",
        )  # fmt: skip
        styles = ("-", "-", ":")
        self._edges = [axes.plot(reel.scene.x, self._u[0], style, color="white", linewidth=1.2)[0] for style in styles]
        axes.set_title(r"white: support edges $u \pm c$; dotted: mean $u$", fontsize="small")
        axes.set_xlabel("x")
        axes.set_ylabel(r"particle velocity $\xi$")
        what = r"$f(x, \xi)$" if reel.density is not None else r"equilibrium $M(h, \xi - u)$"
        figure.colorbar(self._image, ax=axes, label=what, pad=0.01)

        self.moving = [self._image, *self._edges, *axes.spines.values()]

    def show(self, row: int) -> None:
        self._image.set_data(self._density(row).T)
        u, c = self._u[row], self._c[row]
        for line, values in zip(self._edges, (u - c, u + c, u), strict=True):
            line.set_ydata(values)

    def _density(self, row: int) -> Array:
        """The density at the velocities shown, shape (nx, LINES): of the velocity cell that holds them."""
        kept = self._reel.density
        if kept is None:
            return equilibrium(self._reel.h[row], self._u[row], self._reel.scene.beta, self._xi)
        places = (self._xi - kept.offset[row][:, None] - kept.xi[0]) / _width(kept.xi) + 0.5
        column = np.clip(np.floor(places).astype(np.intp), 0, kept.xi.size - 1)
        f = np.take_along_axis(kept.f[row], column, axis=1)
        return np.where((places >= 0.0) & (places < kept.xi.size), f, 0.0)

    def _largest(self) -> float:
        kept, c = self._reel.density, self._c
        return float(kept.f.max() if kept is not None else (c / (np.pi * self._reel.scene.beta)).max()) or 1.0


def _decimals(end: float) -> int:
    """So many tell the frames of a film that ends at `end` apart."""
    return max(0, 2 - int(np.floor(np.log10(end)))) if end > 0.0 else 0


def _width(xi: Array) -> float:
    return float(xi[1] - xi[0]) if xi.size > 1 else 1.0


def _span(*values: Array | None) -> tuple[float, float]:
    """From the least to the largest and 0, with a margin."""
    each = [value[np.isfinite(value)] for value in values if value is not None]
    low, high = min(0.0, *(value.min(initial=0.0) for value in each)), max(value.max(initial=0.0) for value in each)
    span = float(high - low) or 1.0
    return float(low) - 0.05 * span * (low < 0.0), float(high) + 0.05 * span
