"""Two wings seam by seam: the same step from the same state, compared after every stage."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..method import Kinetic, Macroscopic
from ..run import Run
from ..solver.step import Step, step

if TYPE_CHECKING:
    import xarray

HALVES = ("m1, xi > 0", "m2, xi > 0", "m1, xi < 0", "m2, xi < 0")

STAGES = {
    "half": "half-range moments of M",
    "flux": "flux of the upwind face states (19)",
    "balanced_flux": "flux of the balanced face states (25)",
    "transport": "h and q after transport",
    "impulse": "impulse J of gravity and friction",
    "force": "mass and momentum of f after the force",
    "projection": "h and q at the next level",
}


def seams(run: Run, save_every: int, twin: Kinetic | Macroscopic) -> xarray.Dataset:
    """Take one step from each saved state of `run` with its method and with `twin`, and subtract stage by stage.

    Args:
        run: A run of the method under test.
        save_every: Its cadence.
        twin: What it is measured against.

    Returns:
        One variable per stage of `STAGES` that both methods have, the method's less the twin's: `half` has the axes
        (t, moment, x), fluxes (t, component, face), all others (t, component, x), components being h and q; `slow`,
        (t, x), is true where the methods disagree about who is slow.
    """
    import xarray

    if not run.steps:
        raise InputError("seams need at least one step")
    rows: list[dict[str, Array]] = []
    for number, (h, q) in enumerate(zip(run.h, run.q, strict=True)):
        dt = float(run.dt[min(number * save_every, run.steps - 1)])
        rows.append(_apart(step(run.scene, run.method, h, q, dt), step(run.scene, twin, h, q, dt)))
    axes = {
        "half": ("t", "moment", "x"),
        "flux": ("t", "component", "face"),
        "balanced_flux": ("t", "component", "face"),
        "slow": ("t", "x"),
    }
    cells = run.scene.cells
    return xarray.Dataset(
        {
            name: (axes.get(name, ("t", "component", "x")), np.array([row[name] for row in rows]), _attrs(name))
            for name in rows[0]
        },
        coords={
            "t": ("t", run.t, {"long_name": "time", "units": "1"}),
            "x": ("x", run.x, {"long_name": "cell centre along the chute", "units": "1"}),
            "face": ("face", cells.left + cells.dx * np.arange(cells.count + 1), {"long_name": "face", "units": "1"}),
            "moment": list(HALVES),
            "component": ["h", "q"],
        },
    )


def _attrs(name: str) -> dict[str, str]:
    return {"long_name": f"difference in {STAGES.get(name, 'who is slow')}", "units": "1"}


def _apart(one: Step, other: Step) -> dict[str, Array]:
    apart = {"half": one.half - other.half, "flux": one.flux - other.flux}
    if one.balanced_flux is not None and other.balanced_flux is not None:
        apart["balanced_flux"] = one.balanced_flux - other.balanced_flux
    zero = np.zeros_like(one.h)
    return {
        **apart,
        "transport": np.array([one.h1 - other.h1, one.qhat - other.qhat]),
        "impulse": np.array([zero, one.impulse - other.impulse]),
        "force": np.array(_carried(one)) - np.array(_carried(other)),
        "projection": np.array([one.h1 - other.h1, one.q1 - other.q1]),
        "slow": one.slow != other.slow,
    }


def _carried(of: Step) -> tuple[Array, Array]:
    """Mass and momentum of f after the force, or of the state where no density is carried."""
    if of.f_force is None or of.xi is None or of.offset is None:
        return of.h1, of.q1
    dxi = of.xi[1] - of.xi[0]
    mass = dxi * of.f_force.sum(axis=1)
    return mass, dxi * (of.f_force @ of.xi) + of.offset * mass
