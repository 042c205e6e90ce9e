"""What a run and a comparison print."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from .kinetic.velocity import Fitted, Uniform
from .measure.compare import method_name
from .measure.crosscheck import CrossCheck
from .measure.seams import STAGES
from .method import Kinetic, Macroscopic
from .overview import plain_table
from .run import ENDED, Run

if TYPE_CHECKING:
    import xarray


def run_report(
    run: Run,
    asked: Kinetic | Macroscopic,
    files: Mapping[str, Path | None],
    name: str,
    more: Sequence[tuple[str, str]] = (),
) -> None:
    """What a run did and how it ended, `more` about it, where it was written or could be."""
    console = Console()
    console.print(f"[bold]{escape(run.scene.title or name)}[/]: {method_name(run.method)}", highlight=False)
    table = Table.grid(padding=(0, 2))
    for label, value in (*_figures(run, asked), *more):
        table.add_row(f"[dim]{label}[/]", value)
    console.print(table)
    suffixes = {"--out": ".nc", "--plot": ".png"}
    for option, path in files.items():
        remedy = f"not written; {option} {name}{suffixes[option]} would put it there"
        where = f"written to {path}" if path else remedy
        console.print(f"{'run' if option == '--out' else 'picture'}: {escape(where)}", highlight=False, soft_wrap=True)


def _figures(run: Run, asked: Kinetic | Macroscopic) -> list[tuple[str, str]]:
    books = run.entries
    drift = f"{run.mass_drift:+.3e} of the mass"
    if books["coupling_drift"][-1]:
        drift += f", {books['coupling_drift'][-1] / books['mass'][0]:+.3e} of it where two cells chose unlike fluxes"
    good = run.verdict.kind in ENDED
    shown = [
        ("steps", f"{run.steps}, to t = {run.t[-1]:.6g}"),
        ("dt", _span(run.dt)),
        ("Courant number", f"at most {books['courant'].max():.4g}"),
        ("mass drift", drift),
        ("min h", f"{books['h_min'].min():.4g}"),
        ("max |u|", f"{books['u_max'].max():.4g}"),
        ("fronts", _fronts(run)),
        *_window(run.method, asked),
        ("verdict", f"[{'green' if good else 'red'}]{run.verdict}[/]"),
        ("wall time", f"{run.wall_time:.3g} s"),
    ]
    if run.steps:
        each = run.wall_time / (run.steps * run.x.size) * 1e9
        shown.append(("per cell and step", f"{each:.4g} ns"))
        if isinstance(run.method, Kinetic) and isinstance(run.method.velocity, (Uniform, Fitted)):
            shown.append(("per (cell, node)", f"{each / run.method.velocity.count:.3g} ns"))
    return shown


def _span(dt: np.ndarray) -> str:
    if not dt.size:
        return "none taken"
    low, high = f"{dt.min():.4g}", f"{dt.max():.4g}"
    return low if low == high else f"{low} to {high}"


def fronts(run: Run) -> tuple[float, float] | None:
    """The outermost x where h is off the level of its end of the domain at t = 0 by over 1 % of the largest h then."""
    start, end = run.h[0], run.h[-1]
    tolerance = 0.01 * start.max()
    from_left = np.flatnonzero(np.abs(end - start[0]) > tolerance)
    from_right = np.flatnonzero(np.abs(end - start[-1]) > tolerance)
    return (float(run.x[from_left[0]]), float(run.x[from_right[-1]])) if from_left.size and from_right.size else None


def _fronts(run: Run) -> str:
    found = fronts(run)
    if found is None:
        return "none: h stays within 1 % of max h at t = 0 from the level of the ends"
    return (
        f"x = {found[0]:.4g} and {found[1]:.4g}, the outermost h off the level of its end by over 1 % of max h at t = 0"
    )


def _window(method: Kinetic | Macroscopic, asked: Kinetic | Macroscopic) -> list[tuple[str, str]]:
    if not (isinstance(method, Kinetic) and isinstance(method.velocity, Uniform)):
        return []
    found = ", from a run of the closed-form twin" if method != asked else ""
    return [("velocity window", f"|xi| <= {method.velocity.bound:.4g}{found}")]


def comparison(measured: xarray.Dataset) -> None:
    """How far each method is from the first, at some times, and what each run took."""
    console = Console()
    names = [str(name) for name in measured["method"].to_numpy()]
    console.print(f"[bold]{escape(measured.attrs['title'])}[/], against {names[0]}", highlight=False)
    columns = ("h_l1", "h_max", "q_l1", "q_max")
    rows = sorted(set(np.linspace(0, measured.sizes["t"] - 1, 11).astype(int).tolist()))
    for number, name in enumerate(names[1:], start=1):
        table = plain_table(*("t", "L1(h)", "max |h|", "L1(q)", "max |q|"), title=f"difference of {name}", right=True)
        for row in rows:
            at = measured.isel(method=number, t=row)
            table.add_row(f"{float(at['t']):.4g}", *(f"{float(at[key]):.3e}" for key in columns))
        console.print(table)
    table = plain_table("method", "wall time", "verdict")
    for number, name in enumerate(names):
        at = measured.isel(method=number)
        table.add_row(name, f"{float(at['wall_time']):.3g} s", str(at["verdict"].item()))
    console.print(table)


def causes_report(run: Run) -> None:
    """What each stage did over the whole run, if it was booked."""
    if run.causes is None:
        return
    summed, total = run.causes["sum"][-1], run.causes["total"][-1]
    quantities = [str(name) for name in summed["quantity"].to_numpy()]
    table = plain_table("stage", *quantities, title="what each stage did, summed over all steps", right=True)
    for stage in summed["stage"].to_numpy():
        table.add_row(str(stage), *(f"{float(summed.sel(stage=stage, quantity=name)):+.3e}" for name in quantities))
    table.add_row("all", *(f"{float(total.sel(quantity=name)):+.3e}" for name in quantities), style="bold")
    Console().print(table)


def seam_report(measured: xarray.Dataset) -> None:
    """Where the wings part: the largest difference after each stage over all saved states."""
    table = plain_table(
        "after", *(str(twin) for twin in measured["twin"].to_numpy()), title="seams, largest difference"
    )
    for stage, words in STAGES.items():
        if f"seam_{stage}" in measured:
            each = np.abs(measured[f"seam_{stage}"].to_numpy()).reshape(measured.sizes["twin"], -1)
            table.add_row(words, *(f"{largest:.3e}" for largest in each.max(axis=1)))
    unlike = measured["seam_slow"].to_numpy().sum(axis=(1, 2))
    table.add_row("cells judged slow by one wing only", *(str(count) for count in unlike.tolist()))
    Console().print(table)


def crosscheck_report(found: CrossCheck, name: str) -> None:
    """What was found about a flux, regime by regime."""
    title = f"{name}: largest errors in flux scales, beta = {found.beta:g}"
    table = plain_table("regime", "quadrature", "grid", "consistency", "mirror", "", title=title)
    for regime in found.regimes:
        errors = (regime.quadrature, regime.grid, regime.consistency, regime.mirror)
        mark = "[green]passes[/]" if regime.passes else "[red]fails[/]"
        if regime.failure and regime.failure.raised:
            mark = f"[red]fails[/], raised {escape(regime.failure.raised.split(':')[0])}"
        table.add_row(regime.name, *(f"{error:.1e}" for error in errors), mark)
    console = Console()
    console.print(table)
    if found.first_failure:
        console.print(f"first fails: {escape(str(found.first_failure))}", highlight=False, soft_wrap=True)


def validation_report(records: Sequence[Mapping[str, Any]], out: Path) -> None:
    """The claims, script by script, and where the page is."""
    table = plain_table("claim", "measured", "bound", "", "script")
    for record in records:
        for claim in record["claims"]:
            mark = "[green]holds[/]" if claim["holds"] else "[red]fails[/]"
            measured = f"{claim['measured']:.4g}"
            table.add_row(escape(claim["sentence"]), measured, escape(claim["bound"]), mark, record["name"])
    console = Console()
    console.print(table)
    for record in records:
        if record["error"]:
            line = f"[red]broke:[/] {record['name']}: {escape(record['error'])}"
            console.print(line, highlight=False, soft_wrap=True)
    console.print(f"report: {out / 'index.html'}", highlight=False, soft_wrap=True)
