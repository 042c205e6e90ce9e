"""What the commands that take many runs print."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.markup import escape

from .overview import plain_table
from .shell import EXIT_CODES

if TYPE_CHECKING:
    import xarray

    from .trades.advise import Advice
    from .trades.budget import Budget
    from .trades.choose import Chosen


SHOWN = 40
"""Members that a table names; the file has all of them."""


def study_report(found: xarray.Dataset, out: Path) -> None:
    """A line for each member of a study, and where all of it is."""
    dims = [str(dim) for dim in found["verdict"].dims]
    rows = found[[name for name in ("verdict", "wall_time", "mass_drift") if name in found]]
    paths = [str(name) for name in found.coords if found[name].dims and set(found[name].dims) <= set(dims)]
    table = plain_table(*paths, "wall time", "mass drift", "verdict")
    for where in list(np.ndindex(*(found.sizes[dim] for dim in dims)))[:SHOWN]:
        at = rows.isel(dict(zip(dims, where, strict=True)))
        seconds, drift = (f"{float(at[name]):.3g}" if name in at else "" for name in ("wall_time", "mass_drift"))
        values = [str(at[path].item()) for path in paths]
        table.add_row(*map(escape, values), seconds, drift, escape(str(at["verdict"].item()).split(";")[0]))
    console = Console()
    console.print(table)
    more = found["verdict"].size - SHOWN
    told = f"and {more} more; " if more > 0 else ""
    console.print(f"{told}study: written to {escape(str(out))}", highlight=False, soft_wrap=True)


def study_faults(found: xarray.Dataset) -> list[str]:
    """A line for each kind of end that is a fault, with the first of its verdicts."""
    kinds, told = (found[name].to_numpy().ravel().tolist() for name in ("verdict_kind", "verdict"))
    return [
        f"{kinds.count(kind)} of {len(kinds)} members ended {kind}: {told[kinds.index(kind)]}"
        for kind in dict.fromkeys(kinds)
        if EXIT_CODES.get(kind, 1)
    ]


def trade_report(measured: xarray.Dataset, files: list[Path]) -> None:
    """The members that are worth their cost, the others in the files, and what judged them."""
    console = Console()
    front = measured.isel(member=np.flatnonzero(measured["pareto"].to_numpy())).sortby("wall_time")
    title = f"{measured.attrs['title']}; the members that no other beats in both"
    table = plain_table("method", "cells", "Courant", "wall time", "velocity error", "total error", "", title=title)
    for at in range(front.sizes["member"]):
        one = front.isel(member=at)
        figures = (f"{float(one[name]):.3g}" for name in ("wall_time", "velocity_error", "total_error"))
        mark = "knee" if bool(one["knee"]) else ""
        table.add_row(str(one["method"].item()), str(int(one["cells"])), f"{float(one['courant']):g}", *figures, mark)
    console.print(table)
    bad = measured["verdict"].to_numpy()[np.isnan(measured["wall_time"].to_numpy())].tolist()
    for verdict in dict.fromkeys(bad):
        console.print(f"stopped: {escape(str(verdict))}", highlight=False, soft_wrap=True)
    judged = f"errors are L1(h) at the end over the mass, judged by {measured.attrs['judge']}"
    sure = f", itself sure to {measured.attrs['judge_error']:.1e}" if measured.attrs["judge_error"] else ""
    written = ", ".join(str(file) for file in files)
    console.print(f"{judged}{sure}\ntrade: written to {escape(written)}", highlight=False, soft_wrap=True)


def atlas_report(found: xarray.Dataset, *files: Path | None) -> None:
    """How many points of each axis came to what, and those that are neither exact nor stable."""
    from .stability.judge import CLASSES

    axes = [" over ".join(filter(None, pair)) for pair in zip(*(found[name].to_numpy() for name in ("across", "axis")),
                                                              strict=True)]  # fmt: skip
    words = found["class"].to_numpy().tolist()
    table = plain_table("axis", *CLASSES)
    for name in dict.fromkeys(axes):
        here = [word for axis, word in zip(axes, words, strict=True) if axis == name]
        table.add_row(name, *(str(here.count(word) or "") for word in CLASSES))
    console = Console()
    console.print(table)
    firsts = {(axis, word): number for number, (axis, word) in reversed([*enumerate(zip(axes, words, strict=True))])}
    for (axis, word), number in firsts.items():
        if word in ("refused", "non-finite"):
            at = found.isel(point=number)
            value = ", ".join(filter(None, (str(at["value"].item()), str(at["across_value"].item()))))
            line = f"{word} along {axis}, for example at {value}: {str(at['verdict'].item()).split(';')[0]}"
            console.print(escape(line), highlight=False, soft_wrap=True)
    for path in filter(None, files):
        console.print(f"written to {escape(str(path))}", highlight=False, soft_wrap=True)


def accuracy_rows(chosen: Chosen | None, measured: float) -> list[tuple[str, str]]:
    """What was picked and why, and what the velocity error came to be; nothing, if nothing was picked."""
    if chosen is None:
        return []
    colour, word = ("green", "below") if measured <= chosen.accuracy else ("red", "above")
    told = f"{measured:.2g} measured against the twin, predicted at most {chosen.predicted:.2g}"
    judged = f"{told}; [{colour}]{word} the {chosen.accuracy:.2g} asked for[/]"
    if np.isinf(measured):
        judged = "[red]none to be measured: the run, or its twin, did not come to the end[/]"
    return [("picked", escape(chosen.why)), ("velocity error", judged)]


def budget_report(found: Budget, name: str) -> None:
    """Each source of error, and the budget in words."""
    console = Console()
    table = plain_table("source", "L1(h) / mass", title=f"{name}: error budget, judged by {found.judge}")
    shares = {"velocity nodes": found.velocity, "remap of the force": found.force, "dt": found.dt, "dx": found.dx}
    for source, error in {**shares, "the whole": found.total}.items():
        table.add_row(source, "none" if np.isnan(error) else f"{error:.3g}")
    console.print(table)
    console.print(found.words, highlight=False)


def advice_report(found: Advice, name: str) -> None:
    """What a scene needs, part by part."""
    table = plain_table("part", "needed", "because", "costs", title=f"{name}: what it requires")
    for part in found.parts:
        table.add_row(part.name, "[green]yes[/]" if part.needed else "no", escape(part.because), part.costs)
    Console().print(table)
