"""Densities that a run is asked to keep."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from ..balance.stages import Array
from ..value import Number, Whole, value

if TYPE_CHECKING:
    import xarray

    from ..kinetic.wing import Density
    from ..scene import Scene

Stage = Literal["equilibrium", "transport", "force"]

LONG_NAMES = {
    "equilibrium": "density M(h, xi - u) at the beginning of the step",
    "transport": "density after transport",
    "force": "density after the force",
}


@value
class Dump:
    """The density at one stage of the first, of every `every`-th and of the last step of a kinetic run.

    Attributes:
        name: Its name in the run and in the file.
        stage: "equilibrium" (M^n), "transport" (f before the shift) or "force" (f after it).
        every: Cadence in steps.
        x, xi: Windows (low, high), or None for all.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z]\w*$")] = "f"
    stage: Stage = "force"
    every: Annotated[Whole, Field(ge=1)] = 1000
    x: tuple[Number, Number] | None = None
    xi: tuple[Number, Number] | None = None


class Recorder:
    """Collects one dump during a run."""

    def __init__(self, dump: Dump, scene: Scene, density: Density) -> None:
        self.dump = dump
        self._cells = _inside(scene.x, dump.x)
        self._nodes = _inside(density.grid.xi, dump.xi)
        self._x, self._xi = scene.x[self._cells], density.grid.xi[self._nodes]
        self._density = density
        self._times: list[float] = []
        self._rows: list[Array] = []
        self._last = -1

    def record(self, step: int, before: float, after: float, final: bool = False) -> None:
        """Keep the density of step number `step` (counted from 1), from time `before` to `after`, if it is due."""
        if step == self._last or not (final or step == 1 or step % self.dump.every == 0):
            return
        self._last = step
        stage = self.dump.stage
        self._times.append(before if stage == "equilibrium" else after)
        whole = {
            "equilibrium": self._density.M[1:-1],
            "transport": self._density.transported,
            "force": self._density.f,
        }[stage]
        self._rows.append(whole[self._cells, self._nodes].copy())

    def result(self) -> xarray.DataArray:
        """What was kept, with axes (t, x, xi)."""
        import xarray

        rows = np.array(self._rows).reshape(-1, self._x.size, self._xi.size)
        return xarray.DataArray(
            rows,
            dims=("t", "x", "xi"),
            coords={
                "t": ("t", np.array(self._times), {"long_name": "time", "units": "1"}),
                "x": ("x", self._x, {"long_name": "cell centre along the chute", "units": "1"}),
                "xi": ("xi", self._xi, {"long_name": "particle velocity", "units": "1"}),
            },
            attrs={"long_name": LONG_NAMES[self.dump.stage], "units": "1"},
        )


def _inside(places: Array, window: tuple[float, float] | None) -> slice:
    if window is None:
        return slice(None)
    begin, end = np.searchsorted(places, window)
    return slice(int(begin), int(end))
