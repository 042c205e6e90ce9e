"""What a run leaves behind: states, ledger and verdict."""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import TypeAdapter

from .arrays import Array
from .clock import AnyClock, Replay
from .diagnostics.endings import ENDED, Verdict, VerdictKind
from .diagnostics.ledger import EVERY_COLUMN
from .mean import mean_velocity
from .method import Kinetic, Macroscopic
from .scene import Scene
from .store import write_netcdf
from .value import of_outside

if TYPE_CHECKING:
    import xarray

__all__ = ["ENDED", "Run", "Verdict", "VerdictKind", "describe", "description"]


@dataclass(frozen=True, eq=False)
class Run:
    """A finished or stopped run.

    Attributes:
        scene, method, clock: What was run; a velocity grid without a bound has got one.
        t: Saved times, shape (nt,); the first is the start, the last the end.
        h, q: Saved states, shape (nt, nx).
        dt: Length of every step, shape (steps,).
        entries: Ledger columns, each of shape (nt,).
        dumps: Densities that were asked for, by name.
        causes: The moment ledger, if it was asked for; see `kinsim.diagnostics.causes`.
        verdict: How it ended.
        wall_time: Seconds spent in the time loop, compiling excluded.
        awake: Share of the cells, over all steps, that were stepped; the others rested.
        observed: What observers of one's own noted, by their names.
    """

    scene: Scene
    method: Kinetic | Macroscopic
    clock: AnyClock
    t: Array
    h: Array
    q: Array
    dt: Array
    entries: Mapping[str, Array]
    verdict: Verdict
    wall_time: float
    awake: float = 1.0
    dumps: Mapping[str, xarray.DataArray] = field(default_factory=dict)
    causes: xarray.Dataset | None = None
    observed: Mapping[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        return (
            f"<kinsim.Run {self.scene.title or 'untitled'!r}, {self.method.kind}, {self.steps} steps: {self.verdict}>"
        )

    @property
    def x(self) -> Array:
        """Cell centres, shape (nx,)."""
        return self.scene.x

    @property
    @np.errstate(over="ignore")
    def u(self) -> Array:
        """Velocity q/h, 0 where dry, shape (nt, nx)."""
        return mean_velocity(self.q, self.h)

    @property
    def steps(self) -> int:
        """Steps taken."""
        return self.dt.size

    @property
    def replay(self) -> Replay:
        """The clock of the same steps once more."""
        return Replay(tuple(self.dt.tolist()), end=float(self.t[-1]))

    @cached_property
    def ledger(self) -> xarray.Dataset:
        """The books over the saved times; see `kinsim.diagnostics.ledger` for the columns."""
        import xarray

        columns = {name: ("t", column, _attrs(EVERY_COLUMN[name])) for name, column in self.entries.items()}
        return xarray.Dataset(columns, coords={"t": ("t", self.t, _attrs("time"))})

    @property
    def mass_drift(self) -> float:
        """Relative change of mass that no inflow accounts for; what scheme 3 and re-summing make is part of it."""
        mass = self.entries["mass"]
        entered = self.entries["inflow_left"][-1] + self.entries["inflow_right"][-1]
        unit = float(mass[0] or mass.max())  # of a stream onto dry ground: the most there ever was
        return float(mass[-1] - mass[0] - entered) / unit if unit > 0.0 else 0.0

    def to_xarray(self) -> xarray.Dataset:
        """Everything as one labelled dataset; each dump has axes of its own."""
        import xarray

        state = {
            "h": (("t", "x"), self.h, _attrs("height")),
            "q": (("t", "x"), self.q, _attrs("momentum h u")),
            "u": (("t", "x"), self.u, _attrs("velocity q/h, 0 where dry")),
        }
        coords = {"t": ("t", self.t, _attrs("time")), "x": ("x", self.x, _attrs("cell centre along the chute"))}
        dumped = self._dumped()
        dataset = xarray.Dataset(state, coords=coords).merge(self.ledger)
        if self.causes is not None:
            dataset = dataset.merge(self.causes.rename(step="cause_step", sum="cause_sum", total="cause_total"))
        return dataset.assign(dumped).assign_attrs(self.provenance())

    def _dumped(self) -> dict[str, xarray.DataArray]:
        """The dumps on axes that go together: times of their own, x and xi shared unless a window cuts them."""
        widest = max((array["xi"] for array in self.dumps.values()), key=len, default=None)
        shared = {"x": self.x, "xi": widest}
        named = {}
        for name, array in self.dumps.items():
            own = [axis for axis in array.coords if not _same(array[axis], shared.get(str(axis)))]
            named[name] = array.rename({axis: f"{axis}_{name}" for axis in own})
        return named

    def to_netcdf(self, path: str | Path) -> Path:
        """Write `to_xarray()` to a netCDF file, all of it or nothing.

        Raises:
            InputError: The folder does not exist or cannot be written.
        """
        return write_netcdf(self.to_xarray(), path)

    def provenance(self) -> dict[str, Any]:
        """Scene, method, clock and versions as text, with a hash that names the computation."""
        parts = description(self.scene, self.method, self.clock)
        described = {name: json.dumps(keys, sort_keys=True) for name, keys in parts.items()}
        described["kinsim_version"] = version("kinsim")
        packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba", "xarray", "h5netcdf"))
        versions = f"kinsim {described['kinsim_version']}, Python {platform.python_version()}, {packages}"
        digest = hashlib.sha256(
            "\n".join([*described.values(), versions]).encode() + self.h[0].tobytes() + self.q[0].tobytes()
        )
        return {
            "title": self.scene.title or "kinsim run",
            **described,
            "hash": digest.hexdigest(),
            "versions": versions,
            "verdict": self.verdict.kind,
            "verdict_message": self.verdict.message,
            "steps": self.steps,
            "wall_time_seconds": self.wall_time,
            "Conventions": "CF-1.11",
        }


def description(scene: Scene, method: Kinetic | Macroscopic, clock: AnyClock) -> dict[str, Any]:
    """The three as plain keys and values."""
    parts = {"scene": scene, "method": method, "clock": clock}
    return {name: _keys(type(thing), thing) for name, thing in parts.items()}


def describe(kind: Any, thing: Any) -> str:
    """A scene, method or clock as JSON with sorted keys."""
    return json.dumps(_keys(kind, thing), sort_keys=True)


def _keys(kind: Any, thing: Any) -> dict[str, Any]:
    keys = TypeAdapter(kind).dump_python(thing, mode="json")
    own = of_outside(thing)
    return {**keys, "outside": own} if own else keys


def _attrs(long_name: str) -> dict[str, str]:
    return {"long_name": long_name, "units": "1"}


def _same(axis: xarray.DataArray, other: Any) -> bool:
    return other is not None and np.array_equal(axis.to_numpy(), np.asarray(other))
