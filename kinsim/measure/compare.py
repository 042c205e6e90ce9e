"""Several methods on one scene, measured against the first of them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import TYPE_CHECKING

import numpy as np

from ..clock import AnyClock, Courant, Fixed
from ..errors import InputError
from ..interrupt import unless_interrupted
from ..method import Kinetic, Macroscopic
from ..run import Run
from ..scene import Scene
from ..simulate import simulate
from ..simulation import Progress
from .seams import seams as stage_by_stage

if TYPE_CHECKING:
    import xarray


def compare(
    scene: Scene,
    methods: Sequence[Kinetic | Macroscopic],
    clock: Fixed | Courant,
    save_every: int = 100,
    *,
    force: bool = False,
    seams: bool = False,
    progress: Progress | None = None,
) -> xarray.Dataset:
    """Run `methods` and measure how far each is from the first.

    With a `Courant` clock the others repeat the steps of the first, so that all meet at the same times. Where a run
    was stopped, the rows that all runs have are kept, and its verdict says why.

    Args:
        scene: What happens.
        methods: How it is computed, the reference first.
        clock: When.
        save_every: Every so many steps the states are compared, and at the start and at the end.
        force: Run although the CFL bound (28) is broken.
        seams: Also take one step from each saved state of the first method with every method, and subtract stage by
            stage: variables `seam_...` with the dim `twin` (see `kinsim.measure.seams`).
        progress: Called now and then with the share that is done.

    Returns:
        h_l1, q_l1 (integrals over x) and h_max, q_max of the differences, dims (method, t); wall_time in seconds,
        steps, verdict and verdict_kind, dims (method,).

    Raises:
        InputError: There is no method, or a first step would break the CFL bound.
    """
    if not methods:
        raise InputError("compare: no methods; give a reference and what is to be measured against it")
    if seams and len(methods) < 2:
        raise InputError("compare: seams need a second method; give a reference and what it is measured against")
    runs: list[Run] = []
    for number, method in enumerate(methods):
        part = _part(progress, number, len(methods)) if progress else None
        run = simulate(scene, method, _after(runs, clock), save_every, force=force, progress=part)
        runs.append(unless_interrupted(run))
    apart = _differences(runs)
    return apart.merge(_seams(runs, save_every)) if seams else apart


def _seams(runs: list[Run], save_every: int) -> xarray.Dataset:
    import xarray

    against = [stage_by_stage(runs[0], save_every, run.method) for run in runs[1:]]
    joined = xarray.concat(against, dim="twin", join="outer").assign_coords(twin=_labels(runs)[1:])
    return joined.rename({name: f"seam_{name}" for name in joined.data_vars}).rename(t="t_seam")


def _part(progress: Progress, number: int, of: int) -> Progress:
    return lambda share: progress((number + share) / of)


def _after(runs: list[Run], clock: Fixed | Courant) -> AnyClock:
    if not runs or isinstance(clock, Fixed):
        return clock
    return runs[0].replay


def _differences(runs: list[Run]) -> xarray.Dataset:
    import xarray

    t = reduce(np.intersect1d, [run.t for run in runs])
    h, q = (np.array([getattr(run, name)[np.searchsorted(run.t, t)] for run in runs]) for name in "hq")
    dx = runs[0].scene.cells.dx
    measures = {}
    for name, values, word in (("h", h, "height"), ("q", q, "momentum")):
        off = np.abs(values - values[0])
        for suffix, measured, how in (
            ("l1", off.sum(axis=2) * dx, "integral over x of the"),
            ("max", off.max(axis=2), "largest"),
        ):
            attrs = {"long_name": f"{how} difference in {word}", "units": "1"}
            measures[f"{name}_{suffix}"] = (("method", "t"), measured, attrs)
    return xarray.Dataset(
        {
            **measures,
            "wall_time": ("method", [run.wall_time for run in runs], {"long_name": "wall time", "units": "s"}),
            "steps": ("method", [run.steps for run in runs], {"long_name": "steps taken", "units": "1"}),
            "verdict": ("method", [str(run.verdict) for run in runs], {"long_name": "how the run ended"}),
            "verdict_kind": (
                "method",
                [run.verdict.kind for run in runs],
                {"long_name": "how it ended, in a word"},
            ),
        },
        coords={
            "method": ("method", _labels(runs), {"long_name": "method; the first is the reference"}),
            "t": ("t", t, {"long_name": "time", "units": "1"}),
        },
        attrs={"title": runs[0].scene.title or "kinsim comparison"},
    )


def _labels(runs: list[Run]) -> list[str]:
    """A name for each method, alike ones numbered."""
    names = [method_name(run.method) for run in runs]
    return [f"{name} ({names[: i + 1].count(name)})" if names.count(name) > 1 else name for i, name in enumerate(names)]


def method_name(method: Kinetic | Macroscopic) -> str:
    """A method in a few words."""
    words = f"{method.kind}, scheme {method.scheme}"
    if method.scheme == 3 and method.coupling != "cell":
        words += f" by {method.coupling}"
    if method.order != 1:
        words += f", order {method.order}"
    if isinstance(method, Kinetic):
        words += f", {method.velocity.words}"
        if method.equilibrium != "cell-average":
            words += f", {method.equilibrium}"
        if method.force != "shift-linear":
            words += f", {method.force}"
        if method.projection != "flux-difference":
            words += f", {method.projection}"
    return words
