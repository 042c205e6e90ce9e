"""Densities that a run is asked to keep."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from ..arrays import Array
from ..checkpoint import Kept
from ..clock import AnyClock, Fixed
from ..errors import InputError
from ..kinetic.velocity import Grid
from ..memory import require
from ..method import Kinetic, Macroscopic
from ..value import Number, Whole, value
from .ledger import EVERY_COLUMN
from .observer import Observer

if TYPE_CHECKING:
    import xarray

    from ..scene import Scene
    from ..solver.density import Density
    from ..solver.solver import Block

TAKEN = {"t", "x", "xi", "h", "q", "u", "stage", "quantity", *EVERY_COLUMN}
"""Names of other parts of a run."""

Stage = Literal["equilibrium", "held", "transport", "force"]

LONG_NAMES = {
    "equilibrium": "density M(h, xi - u) at the beginning of the step",
    "held": "density that static friction holds back at the walls of its cell",
    "transport": "density after transport",
    "force": "density after the force",
}

SHOWN: dict[Stage, Callable[[Density], Array]] = {
    "equilibrium": lambda density: density.M,
    "held": lambda density: density.held,
    "transport": lambda density: density.transported,
    "force": lambda density: density.f,
}


@value
class Dump:
    """The density at one stage of the first, every `every`-th and last step of a kinetic run that goes to its end.

    Attributes:
        name: Its name in the run and in the file.
        stage: "equilibrium" (M^n), "held" (the part of it that faces hold back in scheme 4), "transport" (f before the
            shift) or "force" (f after it).
        every: Cadence in steps.
        x, xi: Windows (low, high), or None for all.
    """

    name: Annotated[str, Field(pattern=r"^[A-Za-z]\w*$")] = "f"
    stage: Stage = "force"
    every: Annotated[Whole, Field(ge=1)] = 1000
    x: tuple[Number, Number] | None = None
    xi: tuple[Number, Number] | None = None

    def __post_init__(self) -> None:
        if self.name in TAKEN or self.name.startswith("cause_"):
            raise ValueError(f"name = {self.name!r} is taken by another part of a run; choose another, for example f")
        for axis, window in (("x", self.x), ("xi", self.xi)):
            if window and not window[0] < window[1]:
                raise ValueError(f"{axis} = {window[0]:g}:{window[1]:g} is no window; write low:high")


class Recorder(Observer):
    """Collects one dump during a run."""

    def __init__(self, dump: Dump, scene: Scene) -> None:
        self.dump, self.name, self.every = dump, f"dump {dump.name}", dump.every
        self._cells = _inside(scene.x, dump.x)
        self._x = scene.x[self._cells]
        if not self._x.size:
            raise InputError(f"dump {dump.name!r}: no cell centre lies in its window of x; widen it")
        self._dxi = 0.0
        self._times: list[float] = []
        self._rows: list[Array] = []
        self._offsets: list[Array] = []
        self._last = -1

    @property
    def width(self) -> int:
        """Cells of a row."""
        return self._x.size

    def rows(self, steps: int) -> int:
        """How many rows so many steps leave."""
        return steps // self.dump.every + 2

    def next_step(self, step: int) -> float:
        return 1 if step == 0 else super().next_step(step)

    def look(self, block: Block) -> None:
        """Keep the density of the first, every `every`-th and the last step."""
        step = block.step
        if step == self._last or not (block.last or step == 1 or step % self.dump.every == 0):
            return
        self._last = step
        stage, density = self.dump.stage, block.stages.density
        self._dxi = density.grid.dxi
        self._times.append(block.stages.t if stage in ("equilibrium", "held") else block.t)
        self._rows.append(SHOWN[stage](density)[self._cells].copy())
        self._offsets.append(density.offset[self._cells].copy() if stage == "force" else np.zeros(self._x.size))

    def kept(self) -> Kept:
        """The rows so far."""
        rows = {f"row {at}": row for at, row in enumerate(self._rows)}
        offsets = np.array(self._offsets).reshape(-1, self._x.size)
        return {
            "times": np.array(self._times),
            "offsets": offsets,
            "last": np.array(self._last),
            "dxi": np.array(self._dxi),
            **rows,
        }

    def restore(self, kept: Kept) -> None:
        """Go on from there."""
        self._times, self._offsets, self._last = kept["times"].tolist(), list(kept["offsets"]), int(kept["last"])
        self._dxi = float(kept["dxi"])
        self._rows = [kept[f"row {at}"] for at in range(len(self._times))]

    def result(self) -> xarray.DataArray:
        """What was kept, with axes (t, x, xi); where the force moved the nodes, `offset` (t, x) says by how much."""
        import xarray

        grid = Grid(max((rows.shape[1] for rows in self._rows), default=2), self._dxi or 1.0)
        whole = np.zeros((len(self._rows), self._x.size, grid.count))
        for rows, kept in zip(self._rows, whole, strict=True):  # a window that follows is smaller at times
            outside = (grid.count - rows.shape[1]) // 2
            kept[:, outside : grid.count - outside] = rows
        nodes = _inside(grid.xi, self.dump.xi)
        coords = {
            "t": ("t", np.array(self._times), {"long_name": "time", "units": "1"}),
            "x": ("x", self._x, {"long_name": "cell centre along the chute", "units": "1"}),
            "xi": ("xi", grid.xi[nodes], {"long_name": "particle velocity", "units": "1"}),
        }
        attrs = {"long_name": LONG_NAMES[self.dump.stage], "units": "1"}
        array = xarray.DataArray(whole[:, :, nodes], dims=("t", "x", "xi"), coords=coords, attrs=attrs)
        offset = np.array(self._offsets).reshape(-1, self._x.size)
        if offset.any():
            array = array.assign_coords(offset=(("t", "x"), offset, {"long_name": "shift of the nodes", "units": "1"}))
        return array


def _inside(places: Array, window: tuple[float, float] | None) -> slice:
    if window is None:
        return slice(None)
    begin, end = np.searchsorted(places, window)
    return slice(int(begin), int(end))


def require_density(method: Kinetic | Macroscopic) -> Kinetic:
    """The method, if it carries a density on a velocity grid.

    Raises:
        InputError: It does not.
    """
    if not isinstance(method, Kinetic) or method.velocity_cells is None:
        raise InputError("dumps and causes need a density on a velocity grid: take Kinetic with Uniform or Window")
    return method


def recorders(dumps: Sequence[Dump], scene: Scene, method: Kinetic | Macroscopic, clock: AnyClock) -> list[Recorder]:
    """One observer for each dump.

    Raises:
        InputError: Two have one name, the method has no such density, or they do not fit into memory.
    """
    names = [dump.name for dump in dumps]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two dumps are called {name!r}; give each a name of its own")
    if not dumps:
        return []
    cells = require_density(method).velocity_cells
    if any(dump.stage == "held" for dump in dumps) and (method.scheme, method.order, method.statics) != (4, 1, "hold"):
        raise InputError('a dump of the stage "held" needs faces that hold: take scheme 4 of order 1')
    made = [Recorder(dump, scene) for dump in dumps]
    for recorder in made:
        rows = recorder.rows(clock.steps if isinstance(clock, Fixed) else 1)
        width = getattr(cells, "count", 2)
        require(rows * 8.0 * recorder.width * width, f"{rows} rows of the dump {recorder.dump.name!r}")
    return made
