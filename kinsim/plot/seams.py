"""Where two wings part: the differences after each stage of a step, over x."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..measure.seams import STAGES
from .picture import save

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


def plot_seams(measured: xarray.Dataset, path: str | Path) -> Path:
    """Draw the seams of a comparison, `kinsim.compare(..., seams=True)`: the largest difference over the saved times.

    Raises:
        InputError: The picture cannot be put there.
    """
    return save(draw_seams(measured), path)


def draw_seams(measured: xarray.Dataset) -> Figure:
    """The figure of `plot_seams`, one row per stage, one column per method that was measured."""
    from matplotlib.figure import Figure

    stages = [stage for stage in STAGES if f"seam_{stage}" in measured]
    twins = [str(twin) for twin in measured["twin"].to_numpy()]
    figure = Figure(figsize=(1.0 + 7.0 * len(twins), 1.6 * len(stages) + 1.0), layout="constrained")
    all_axes = figure.subplots(len(stages), len(twins), sharex=True, squeeze=False)
    figure.suptitle(f"{measured.attrs['title']}: {measured['method'].to_numpy()[0]}, stage by stage")
    for column, twin in enumerate(twins):
        all_axes[0, column].set_title(f"less {twin}; largest |difference| over the saved times", fontsize="medium")
        for row, stage in enumerate(stages):
            _stage(measured[f"seam_{stage}"].isel(twin=column), stage, all_axes[row, column])
        all_axes[-1, column].set_xlabel("x (all quantities dimensionless)")
    return figure


def _stage(apart: xarray.DataArray, stage: str, axes: Any) -> None:
    place = "face" if "face" in apart.dims else "x"
    lines = "moment" if "moment" in apart.dims else "component"
    largest = abs(apart).max("t_seam")
    for number, name in enumerate(apart[lines].to_numpy()):
        values = largest.sel({lines: name}).to_numpy()
        if values.any():
            style = ("-", "--", "-.", ":")[number]
            axes.plot(apart[place], np.where(values > 0, values, np.nan), style, color=_colour(number), label=str(name))
    if float(largest.max()) > 0.0:
        axes.set_yscale("log")
        top = float(largest.max())
        axes.set_ylim(max(1e-6 * top, 1e-18), 100.0 * top)
        axes.legend(frameon=False, fontsize="small", loc="upper right", ncols=4)
    else:
        axes.text(0.5, 0.5, "no difference", transform=axes.transAxes, ha="center", va="center", color="0.4")
        axes.set_yticks([])
    axes.set_ylabel(_label(stage), fontsize="small", rotation=0, ha="right", va="center")


def _label(stage: str) -> str:
    words = STAGES[stage].split()
    half = (len(words) + 1) // 2
    return " ".join(words[:half]) + "\n" + " ".join(words[half:])


def _colour(number: int) -> str:
    """Okabe and Ito's colours for the colour-blind."""
    return ("#0072b2", "#d55e00", "#009e73", "#cc79a7")[number]
