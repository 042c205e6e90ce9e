"""A scene over a family of methods: what each costs, and how far it is off."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..clock import Courant, Fixed
from ..errors import InputError
from ..measure.compare import method_name
from ..method import Kinetic, Macroscopic
from ..run import ENDED
from ..scene import Scene
from ..studies.engine import Tell
from ..studies.given import check_given
from ..studies.study import study
from .family import Choice, chosen
from .front import knee, pareto
from .judge import Judge, judge, mass_of
from .pace import finer, steady, twin_of, varied

if TYPE_CHECKING:
    import xarray

WORDS = {
    "wall_time": ("time in the time loop, median", "s"),
    "wall_time_low": ("time in the time loop, least", "s"),
    "wall_time_high": ("time in the time loop, greatest", "s"),
    "ns_per_cell_step": ("time per cell and step, median", "ns"),
    "memory": ("most memory taken at once", "byte"),
    "velocity_error": ("L1(h) to the closed-form twin at the end, over the mass at the start and what comes in", "1"),
    "total_error": ("L1(h) to the judge at the end, over the mass at the start and what comes in", "1"),
    "rest_residual": ("largest |h u| where the twin is at rest at the end", "1"),
    "pareto": ("whether no other member is both faster and nearer", "1"),
    "knee": ("whether it is the knee of those", "1"),
}


def trade(
    scene: Scene,
    method: Kinetic | Macroscopic,
    clock: Fixed | Courant,
    *,
    lines: Sequence[str] | None = None,
    family: Sequence[Choice] | None = None,
    repeats: int = 5,
    keep: str | Path | None = None,
    resume: bool = False,
    tell: Tell | None = None,
) -> xarray.Dataset:
    """Run a scene over a family of methods, and measure cost and errors of each.

    All members of one order, dx and Courant number take the same steps, so that a velocity error is none of time.

    Args:
        scene: What happens.
        method: Whose scheme, order, limiter, coupling and statics are taken.
        clock: Its end is the end of each run.
        lines: Parts of the default family, see `kinsim.trades.family`; None takes all.
        family: Choices of your own instead.
        repeats: So often each is run, alone and in turn, to be timed.
        keep: Folder for what is measured, as in `kinsim.study`.
        resume: Take from it what was measured before.
        tell: Called with what is under way and the share that is done.

    Returns:
        Over "member": line, method, nodes, cells, courant; wall_time (median, in s) with _low and _high,
        ns_per_cell_step, memory (bytes), velocity_error, total_error (both L1(h) over the mass), mass_drift,
        rest_residual, pareto, knee, verdict. A member that fails is a row with its verdict and NaN.

    Raises:
        InputError: The family is empty, the scene has no mass, or the reference does not come to the end.
        KeyboardInterrupt: Ctrl-C; what is measured is in `keep`.
    """
    check_given("trade", scene, method, clock)
    if family is not None and not family:
        raise InputError("trade: the family is empty; give at least one choice")
    picked = list(family) if family is not None else chosen(method, lines)
    for at, one in enumerate(picked):
        if not isinstance(one, Choice):
            raise InputError(f"trade: family[{at}] is a {type(one).__name__}; give kinsim.trades.family.Choice(...)")
    end, mass = clock.end, mass_of(scene, clock.end)
    options: dict[str, Any] = {"keep": keep, "resume": resume}
    paces: dict[Any, Fixed] = {}

    def part(first: float, last: float) -> Tell | None:
        return (lambda what, share: tell(what, first + (last - first) * share)) if tell else None

    against = judge(scene, end, max(one.cells for one in picked), **options, tell=part(0.0, 0.2))
    over = _over(scene, picked, end, paces)
    short = {**over, "clock": [Fixed(one.dt, min(3, one.steps)) for one in over["clock"]]}
    memory = study(scene, method, clock, short, paired=True, traced=True, **options, tell=part(0.2, 0.3))
    twins = {**over, "method": [twin_of(one.method) for one in picked]}
    closed = study(scene, method, clock, twins, paired=True, **options, tell=part(0.3, 0.4))
    timed = study(scene, method, clock, over, paired=True, repeats=repeats, **options, tell=part(0.4, 1.0))
    return _measured(picked, timed, closed, memory, against, mass, scene)


def _over(scene: Scene, family: Sequence[Choice], end: float, paces: dict[Any, Fixed]) -> dict[str, list[Any]]:
    """The lists of a paired study."""
    scenes = [finer(scene, one.cells) for one in family]
    counts = [one.cells.count for one in scenes]
    for one, its in zip(family, scenes, strict=True):
        asked = (twin_of(one.method), its.cells.count, one.number)
        if asked not in paces:
            paces[asked] = steady(its, one.method, one.number, end)
    clocks = [paces[twin_of(one.method), count, one.number] for one, count in zip(family, counts, strict=True)]
    return {"method": [one.method for one in family], **varied(scenes), "clock": clocks}


def _measured(
    family: Sequence[Choice],
    timed: xarray.Dataset,
    closed: xarray.Dataset,
    memory: xarray.Dataset,
    against: Judge,
    mass: float,
    scene: Scene,
) -> xarray.Dataset:
    import xarray

    times = timed["wall_time"].to_numpy().reshape(len(family), -1)
    good = np.isin(timed["verdict_kind"].to_numpy(), ENDED)
    errors = np.full((3, len(family)), np.nan)
    for at, one in enumerate(family):
        if good[at]:
            errors[:, at] = _errors(finer(scene, one.cells), timed.isel(member=at), closed.isel(member=at), against)
    wall = np.where(good, np.median(times, axis=1), np.nan)
    velocity, total, rest = errors[0] / mass, errors[1] / mass, errors[2]
    front = pareto(wall, total)
    columns = {
        "wall_time": wall, "wall_time_low": times.min(axis=1), "wall_time_high": times.max(axis=1),
        "ns_per_cell_step": 1e9 * wall / timed["cell_steps"].to_numpy(), "memory": memory["memory"].to_numpy(),
        "velocity_error": velocity, "total_error": total, "rest_residual": rest,
        "pareto": np.isin(np.arange(len(family)), front), "knee": np.arange(len(family)) == knee(wall, total, front),
    }  # fmt: skip
    variables = {
        name: ("member", column, {"long_name": WORDS[name][0], "units": WORDS[name][1]})
        for name, column in columns.items()
    }
    coords = {
        "line": ("member", [one.line for one in family]),
        "method": ("member", [method_name(one.method) for one in family]),
        "order": ("member", [one.method.order for one in family]),
        "nodes": ("member", [one.nodes for one in family]),
        "cells": ("member", timed["cells.count"].to_numpy()),
        "courant": ("member", [one.number for one in family]),
    }
    kept = timed[["mass_drift", "steps", "cell_steps", "verdict", "verdict_kind"]].reset_coords(drop=True)
    attrs = {
        **timed.attrs, "title": f"{scene.title or 'untitled'}: cost against error", "judge": against.what,
        "judge_error": against.error,
    }  # fmt: skip
    return xarray.Dataset(variables, coords=coords, attrs=attrs).merge(kept).assign_attrs(attrs)


def _errors(scene: Scene, run: xarray.Dataset, twin: xarray.Dataset, against: Judge) -> tuple[float, float, float]:
    """L1(h) to the twin and to the judge, and the largest |h u| where the twin rests."""
    count, dx = scene.cells.count, scene.cells.dx
    h, u, h_twin, u_twin = (one[name].to_numpy()[:count] for one in (run, twin) for name in ("h", "u"))
    resting: Array = np.abs(h * u)[u_twin == 0.0]
    return (
        float(np.abs(h - h_twin).sum() * dx),
        float(np.abs(h - against.averages(scene.cells)).sum() * dx),
        float(resting.max()) if resting.size else np.nan,
    )
