"""Dumps of f: pictures over (x, xi) at several times, and cuts f(xi) at chosen places beside M."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..diagnostics.dump import LONG_NAMES
from ..errors import InputError
from ..film.reel import equilibrium
from ..run import Run
from .picture import save

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

PICTURES = 4
"""Times shown."""

CUTS = 3
"""Places shown if none are chosen."""


def plot_density(run: Run, path: str | Path, name: str = "f", places: Sequence[float] = ()) -> Path:
    """Draw the dump `name` of `run`: over (x, xi) at up to four times, and at the last one as cuts at `places`.

    Beside each cut stands M of the state at that time, beside each picture its support u +- c. What faces hold back is
    cut out of M.

    Raises:
        InputError: There is no such dump, a place lies outside it, or the picture cannot be put there.
    """
    if name not in run.dumps:
        raise InputError(f"no dump {name!r} in this run; there are: {', '.join(run.dumps) or 'none'}")
    dump = run.dumps[name]
    x = dump["x"].to_numpy()
    if not dump.size:
        raise InputError(f"the dump {name!r} is empty; widen its windows")
    for place in places:
        if not x[0] - run.scene.cells.dx <= place <= x[-1] + run.scene.cells.dx:
            raise InputError(f"no cut at x = {place:g}; the dump {name!r} reaches from {x[0]:g} to {x[-1]:g}")
    return save(draw_density(run, dump, places), path)


def draw_density(run: Run, dump: xarray.DataArray, places: Sequence[float]) -> Figure:
    """The figure of `plot_density`."""
    from matplotlib.figure import Figure

    rows = sorted(set(np.linspace(0, dump.sizes["t"] - 1, PICTURES).astype(int).tolist()))
    chosen = [int(np.argmin(np.abs(dump["x"].to_numpy() - place))) for place in places] or _telling(dump)
    columns = max(len(rows), 1)
    figure = Figure(figsize=(3.2 * columns + 1.0, 7.0), layout="constrained")
    halves = figure.add_gridspec(2, 1)
    above, below = figure.add_subfigure(halves[0]), figure.add_subfigure(halves[1])
    figure.suptitle(f"{run.scene.title or 'untitled'}: {dump.attrs['long_name']}")
    _pictures(run, dump, rows, chosen, above)
    _cuts(run, dump, chosen, below)
    return figure


def _pictures(run: Run, dump: xarray.DataArray, rows: list[int], chosen: list[int], figure: Any) -> None:
    all_axes = np.atleast_1d(figure.subplots(1, len(rows), sharey=True))
    x, xi = dump["x"].to_numpy(), dump["xi"].to_numpy()
    top = float(dump.max())
    for axes, row in zip(all_axes, rows, strict=True):
        image = axes.pcolormesh(x, xi, dump[row].to_numpy().T, cmap="viridis", vmin=0.0, vmax=top, rasterized=True)
        h, u = _state(run, float(dump["t"][row]), x)
        c = np.sqrt(2.0 * _beta(run, x) * np.maximum(h, 0.0))
        for edge in (u - c, u + c):
            axes.plot(x, edge, color="white", linewidth=1.0)
        for number, cell in enumerate(chosen):
            axes.axvline(x[cell], color=_colour(number), linewidth=1.2, linestyle="--")
        axes.set_title(f"t = {float(dump['t'][row]):.3g}", fontsize="medium")
        axes.set_xlabel("x")
    all_axes[0].set_ylabel(r"particle velocity $\xi$")
    what = "held back" if _is_held(dump) else r"$f(x, \xi)$"
    figure.colorbar(image, ax=list(all_axes), label=rf"{what}; white: $u \pm c$", pad=0.01)


def _beta(run: Run, x: Array) -> Array:
    """beta of the cells at the places x."""
    return np.asarray(np.interp(x, run.x, np.broadcast_to(run.scene.beta, run.x.shape)))


def _cuts(run: Run, dump: xarray.DataArray, chosen: list[int], figure: Any) -> None:
    all_axes = np.atleast_1d(figure.subplots(1, len(chosen), sharey=True))
    xi, t = dump["xi"].to_numpy(), float(dump["t"][-1])
    x = dump["x"].to_numpy()
    h, u = _state(run, t, x)
    for number, (axes, cell) in enumerate(zip(all_axes, chosen, strict=True)):
        fine = np.linspace(xi[0], xi[-1], 801)
        beta = _beta(run, x)[cell]
        state = h[cell : cell + 1], u[cell : cell + 1], beta
        M = equilibrium(*state, fine)[0]
        moved = float(dump["offset"][-1, cell]) if "offset" in dump.coords else 0.0
        f, edges = dump[-1, cell].to_numpy(), _edges(xi) + moved
        if _is_held(dump):  # the outer shell of M: what is left of M goes on
            here = equilibrium(*state, xi)[0]
            axes.stairs(
                here, edges, baseline=np.maximum(here - f, 0.0), fill=True, color=_colour(number), label="held back"
            )
        else:
            axes.stairs(f, edges, color=_colour(number), linewidth=1.6, label="f")
        axes.plot(fine, M, color="black", linewidth=1.0, label=r"$M(h, \xi - u)$")
        axes.axvline(0.0, color="0.7", linewidth=0.8)
        axes.set_title(f"cut at x = {x[cell]:.3g}, t = {t:.3g}", fontsize="medium")
        axes.set_xlabel(r"particle velocity $\xi$ (all quantities dimensionless)")
        axes.legend(frameon=False)
    all_axes[0].set_ylabel("density")


def _state(run: Run, t: float, x: Array) -> tuple[Array, Array]:
    """h and u of the saved row nearest to the time t, in the cells at x."""
    row = int(np.argmin(np.abs(run.t - t)))
    cells = np.searchsorted(run.x, x)
    return run.h[row, cells], run.u[row, cells]


def _telling(dump: xarray.DataArray) -> list[int]:
    """Cells spread over where there is most mass at the last time."""
    mass = np.cumsum(np.maximum(dump[-1].to_numpy(), 0.0).sum(axis=1))
    shares = (np.arange(CUTS) + 0.5) / CUTS
    return sorted({int(cell) for cell in np.searchsorted(mass, shares * mass[-1])}) if mass[-1] > 0 else [0]


def _is_held(dump: xarray.DataArray) -> bool:
    """Whether it shows what faces hold back of M, rather than a density."""
    return bool(dump.attrs["long_name"] == LONG_NAMES["held"])


def _edges(xi: Array) -> Array:
    half = 0.5 * (xi[1] - xi[0]) if xi.size > 1 else 0.5
    return np.append(xi - half, xi[-1] + half)


def _colour(number: int) -> str:
    """Okabe and Ito's colours for the colour-blind, those that show on viridis."""
    return ("#d55e00", "#cc79a7", "#56b4e9", "#e69f00", "#009e73")[number % 5]
