"""What is known before a run: the built-in scenes, a scene file with all that was filled in, its first step."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from pydantic import TypeAdapter
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from .clock import Fixed, first_courant
from .diagnostics.resolution import unresolved
from .read import SceneFile
from .rooms import rooms

ROWS = 100
"""States that a command keeps, about."""


def scene_list(scenes: Mapping[str, Mapping[str, Any]]) -> None:
    """The built-in scenes, by the keys of their files."""
    table = plain_table("scene", "figure", "what happens")
    for name, keys in scenes.items():
        table.add_row(name, keys["figure"], keys["title"])
    Console().print(table)


def room_list() -> None:
    """Every variant of every family, with the key and the word that choose it in a scene file."""
    table = plain_table("key", "value", "what it is")
    before = ""
    for room in rooms():
        table.add_row("" if room.key == before else room.key, room.name, escape(room.line))
        before = room.key
    Console().print(table)


def first_steps(file: SceneFile) -> float:
    """So many steps it takes, as far as the start tells."""
    clock = file.clock
    return clock.steps if isinstance(clock, Fixed) else clock.end * file.scene.fastest / (clock.number * file.cells.dx)


def saved_every(file: SceneFile) -> int:
    """So many steps from one saved state to the next make about `ROWS` of them."""
    return max(1, int(min(first_steps(file) / ROWS, 1e9)))


def filled_in(file: SceneFile, keys: Mapping[str, Any]) -> None:
    """Every key of a scene file with its value, whether the file gave it, and what follows from them."""
    table = plain_table("key", "value", "from")
    given = _flat(keys)
    for key, value in _flat(TypeAdapter(SceneFile).dump_python(file, mode="json")).items():
        source = "file" if key in given else "filled in"
        table.add_row(escape(key), escape(_short(value)), source if source == "file" else f"[yellow]{source}[/]")
    for key, value in (
        ("dx", file.cells.dx),
        ("beta", file.beta),
        ("R", file.resistance),
        ("Courant number of the first step", first_courant(file.scene, file.clock)),
    ):
        table.add_row(key, _figure(value), "[cyan]follows[/]")
    Console().print(table)
    cells, scene = file.method.velocity_cells, file.scene
    bound = getattr(cells, "bound", None) or 1.05 * scene.fastest
    words = unresolved(cells, bound, scene.beta, scene.initial()[0])
    if words:
        Console().print(f"[yellow]{escape(words)}[/]", highlight=False)


def _figure(value: Any) -> str:
    """A number, or from where to where it varies."""
    low, high = float(np.min(value)), float(np.max(value))
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"


def _flat(keys: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in sorted(keys.items(), key=lambda item: item[0] != "kind"):
        flat |= _flat(value, f"{before}{key}.") if isinstance(value, Mapping) else {f"{before}{key}": value}
    return flat


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else f"{text[:57]}..."


def plain_table(*columns: str, title: str | None = None, right: bool = False) -> Table:
    """A table without lines."""
    table = Table(title=title, title_justify="left", box=None, header_style="bold", padding=(0, 2, 0, 0))
    for column in columns:
        table.add_column(column, justify="right" if right else "left")
    return table
