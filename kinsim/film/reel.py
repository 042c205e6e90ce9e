"""What a film shows: some rows of a run, evenly spread over time, with or without a density."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from ..arrays import Array, Local
from ..diagnostics.dump import LONG_NAMES
from ..kinetic.velocity import Fitted
from ..measure.compare import method_name
from ..memory import require
from ..method import Kinetic, Macroscopic
from ..run import Run
from ..scene import Scene
from ..value import Whole, checked

if TYPE_CHECKING:
    import xarray

Rows = NDArray[np.intp]

FILM = 1e-6
"""Films thinner than this share of the highest cell are drawn at rest."""

MOST_FRAMES = 600
"""A film of more would be too large for a page."""

Frames = Annotated[Whole, Field(ge=2, le=MOST_FRAMES)]


@dataclass(frozen=True, eq=False)
class Dumped:
    """A density on velocity nodes.

    Attributes:
        xi: Nodes, shape (n,).
        f: Shape (nt, nx, n).
        offset: By so much the force moved the nodes, shape (nt, nx).
    """

    xi: Array
    f: Array
    offset: Array


@dataclass(frozen=True, eq=False)
class Reel:
    """Rows of a run, in the order they are shown; all quantities are dimensionless.

    Attributes:
        scene, method: What was run.
        t: Times, shape (nt,).
        h, u: Height and velocity, shape (nt, nx).
        density: After the force, if there is a dump for each row; M follows from h and u.
        twin: h and u of the twin in closed form, each of shape (nt, nx), not-a-number in rows that it did not reach.
    """

    scene: Scene
    method: Kinetic | Macroscopic
    t: Array
    h: Array
    u: Array
    density: Dumped | None = None
    twin: tuple[Array, Array] | None = None

    @property
    def title(self) -> str:
        """Scene and method in a line."""
        return f"{self.scene.title or 'untitled'}: {method_name(self.method)}"

    @property
    def kinetic(self) -> bool:
        """Whether particles have velocities of their own."""
        return isinstance(self.method, Kinetic)


def reel_of(run: Run, frames: int, twin: Run | None = None) -> Reel:
    """At most `frames` rows of `run`, the first and the last included, beside those of its `twin` at the same times.

    Raises:
        InputError: `frames` is no number from 2 to 600.
    """
    reel = cut(run.scene, run.method, run.t, run.h, run.u, run.dumps, frames)
    return replace(reel, twin=_beside(twin, reel)) if twin else reel


def cut(
    scene: Scene,
    method: Kinetic | Macroscopic,
    t: Array,
    h: Array,
    u: Array,
    dumps: Mapping[str, xarray.DataArray],
    frames: int,
) -> Reel:
    """At most `frames` rows; where a dump of f goes along with the saved states, those at its times."""
    frames = checked("film: frames", Frames, frames)
    dump = next((dump for dump in dumps.values() if _serves(dump, t)), None) if isinstance(method, Kinetic) else None
    rows: Rows = np.arange(t.size)
    if dump is not None:
        rows = np.union1d([0], np.flatnonzero(np.isin(t, dump["t"].to_numpy())))
    rows = _evenly(t, rows, frames)
    reel = Reel(scene, method, t[rows], h[rows], u[rows])
    return reel if dump is None else replace(reel, density=_dumped(dump, reel))


def equilibrium(h: Array, u: Array, beta: Local, xi: Array) -> Array:
    """M(h, xi - u) of (3) at the velocities xi of shape (n,), shape (nx, n)."""
    beta = np.asarray(beta)[..., None]
    square = 2.0 * beta * np.maximum(h, 0.0)[:, None] - (xi - u[:, None]) ** 2
    return np.asarray(np.sqrt(np.maximum(square, 0.0)) / (np.pi * beta))


def visible(h: Array, u: Array) -> Array:
    """u of shape (..., nx), and 0 in films too thin to be seen, whose velocities would fill a picture."""
    return np.where(h > FILM * h.max(axis=-1, keepdims=True), u, 0.0)


def carries(method: Kinetic | Macroscopic) -> bool:
    """Whether its density lives on a grid that can be kept; fitted nodes carry M itself."""
    return isinstance(method, Kinetic) and not isinstance(method.velocity, Fitted)


def _serves(dump: xarray.DataArray, t: Array) -> bool:
    """Whether it is f after the force in all cells and meets the saved states more often than at both ends."""
    met = int(np.isin(t[1:], dump["t"].to_numpy()).sum())
    return dump.attrs["long_name"] == LONG_NAMES["force"] and dump.size > 0 and met >= min(3, max(t.size - 1, 1))


def _evenly(t: Array, rows: Rows, frames: int) -> Rows:
    """At most `frames` of the rows, as evenly spread over time as they are."""
    if rows.size <= frames:
        return rows
    wanted = np.linspace(t[rows[0]], t[rows[-1]], frames)
    return np.unique([rows[np.argmin(np.abs(t[rows] - time))] for time in wanted])


def _dumped(dump: xarray.DataArray, reel: Reel) -> Dumped:
    """The dump at the times of the reel; what it lacks, the start, is M."""
    times, xi = dump["t"].to_numpy(), dump["xi"].to_numpy()
    shape = (reel.t.size, *dump.shape[1:])
    require(8.0 * math.prod(shape), f"the density in {reel.t.size} frames")
    f = np.empty(shape)
    offset = np.zeros(f.shape[:2])
    for row, time in enumerate(reel.t):
        here = np.flatnonzero(times == time)
        if here.size:
            f[row] = dump[here[0]].to_numpy()
            offset[row] = dump["offset"][here[0]].to_numpy() if "offset" in dump.coords else 0.0
        else:
            f[row] = equilibrium(reel.h[row], reel.u[row], reel.scene.beta, xi)
    return Dumped(xi, f, offset)


def _beside(twin: Run, reel: Reel) -> tuple[Array, Array]:
    """h and u of the twin at the times of the reel."""
    sides = []
    for values in (twin.h, twin.u):
        side = np.full_like(reel.h, np.nan)
        for row, time in enumerate(reel.t):
            here = np.flatnonzero(twin.t == time)
            side[row] = values[here[0]] if here.size else np.nan
        sides.append(side)
    return sides[0], sides[1]
