"""What the commands print: tables."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import TypeAdapter
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from .clock import Fixed
from .kinetic.velocity import Fitted, Uniform
from .measure.compare import method_name
from .method import Kinetic, Macroscopic
from .read import SceneFile
from .run import Run

if TYPE_CHECKING:
    import xarray

ROWS = 100
"""States that a command keeps, about."""


def scene_list(scenes: Mapping[str, Mapping[str, Any]]) -> None:
    """The built-in scenes, by the keys of their files."""
    table = _table("scene", "figure", "what happens")
    for name, keys in scenes.items():
        table.add_row(name, keys["figure"], keys["title"])
    Console().print(table)


def first_speed(file: SceneFile) -> float:
    """The fastest particle at the start, max(|u| + c)."""
    h, q = file.scene.initial()
    u = np.divide(q, h, out=np.zeros_like(q), where=h > 0)
    return float(np.max(np.abs(u) + np.sqrt(2.0 * file.scene.beta * h)))


def first_courant(file: SceneFile) -> float:
    """The Courant number of the first step, in closed form."""
    clock = file.clock
    return first_speed(file) * clock.dt / file.cells.dx if isinstance(clock, Fixed) else clock.number


def saved_every(file: SceneFile) -> int:
    """So many steps from one saved state to the next make about `ROWS` of them."""
    clock = file.clock
    steps = clock.steps if isinstance(clock, Fixed) else clock.end * first_speed(file) / (clock.number * file.cells.dx)
    return max(1, int(steps / ROWS))


def run_report(run: Run, asked: Kinetic | Macroscopic, files: Mapping[str, Path | None], name: str) -> None:
    """What a run did and how it ended, where it was written or could be."""
    console = Console()
    console.print(f"[bold]{escape(run.scene.title or name)}[/]: {method_name(run.method)}", highlight=False)
    table = Table.grid(padding=(0, 2))
    for label, value in _figures(run, asked):
        table.add_row(f"[dim]{label}[/]", value)
    console.print(table)
    suffixes = {"--out": ".nc", "--plot": ".png"}
    for option, path in files.items():
        what = "run" if option == "--out" else "picture"
        remedy = f"not written; {option} {escape(name)}{suffixes[option]} would put it there"
        console.print(
            f"{what}: {f'written to {escape(str(path))}' if path else remedy}", highlight=False, soft_wrap=True
        )


def _figures(run: Run, asked: Kinetic | Macroscopic) -> list[tuple[str, str]]:
    books = run.entries
    drift = f"{run.mass_drift:+.3e} of the mass"
    if books["coupling_drift"][-1]:
        drift += f", {books['coupling_drift'][-1] / books['mass'][0]:+.3e} of it where two cells chose unlike fluxes"
    good = run.verdict.kind in ("finished", "at-rest")
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
        table = _table(*("t", "L1(h)", "max |h|", "L1(q)", "max |q|"), title=f"difference of {name}", right=True)
        for row in rows:
            at = measured.isel(method=number, t=row)
            table.add_row(f"{float(at['t']):.4g}", *(f"{float(at[key]):.3e}" for key in columns))
        console.print(table)
    table = _table("method", "wall time", "verdict")
    for number, name in enumerate(names):
        at = measured.isel(method=number)
        table.add_row(name, f"{float(at['wall_time']):.3g} s", str(at["verdict"].item()))
    console.print(table)


def filled_in(file: SceneFile, keys: Mapping[str, Any]) -> None:
    """Every key of a scene file with its value, whether the file gave it, and what follows from them."""
    table = _table("key", "value", "from")
    given = _flat(keys)
    for key, value in _flat(TypeAdapter(SceneFile).dump_python(file, mode="json")).items():
        source = "file" if key in given else "filled in"
        table.add_row(escape(key), escape(_short(value)), source if source == "file" else f"[yellow]{source}[/]")
    for key, value in (
        ("dx", file.cells.dx),
        ("beta", file.beta),
        ("R", file.resistance),
        ("Courant number of the first step", first_courant(file)),
    ):
        table.add_row(key, f"{value:.6g}", "[cyan]follows[/]")
    Console().print(table)


def _flat(keys: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in sorted(keys.items(), key=lambda item: item[0] != "kind"):
        flat |= _flat(value, f"{before}{key}.") if isinstance(value, Mapping) else {f"{before}{key}": value}
    return flat


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _table(*columns: str, title: str | None = None, right: bool = False) -> Table:
    table = Table(title=title, title_justify="left", box=None, header_style="bold", padding=(0, 2, 0, 0))
    for column in columns:
        table.add_column(column, justify="right" if right else "left")
    return table
