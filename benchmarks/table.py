"""All measurements against their targets, in one table and in out/benchmarks.json.

Ratios of medians count, taken in turn in one process on one thread; seconds are of this machine. With --quick the
sizes are small and the rounds few.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import time
from dataclasses import asdict
from pathlib import Path

import fluxes
import grid
import growth
import required
import shell
import studies
import where
from rich.console import Console
from rich.table import Table
from rows import Row

HEADS = ["what", "measured", "target", "", "times"]


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small sizes, few rounds")
    parser.add_argument("--out", type=Path, default=Path("out/benchmarks.json"))
    asked = parser.parse_args()
    began = time.perf_counter()
    console = Console(width=None if os.isatty(1) else 160)
    found: list[Row] = []
    for rows in (
        grid.rows(asked.quick),
        fluxes.rows(asked.quick),
        required.rows(asked.quick),
        growth.rows(asked.quick),
        shell.rows(asked.quick),
        studies.rows(asked.quick),
    ):
        for row in rows:
            found.append(row)
            if console.is_terminal:
                console.print(f"{row.what}: {row.verdict}", style="dim")
    console.print(table(found))
    missed = sum(row.verdict == "missed" for row in found)
    met = sum(row.verdict == "met" for row in found)
    console.print(f"{met} met, {missed} missed; {time.perf_counter() - began:.0f} s on {platform.machine()}")
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    profile = [list(part) for part in where.parts(asked.quick)]
    record = {
        "rows": [{**asdict(row), "verdict": row.verdict} for row in found],
        "tables": [
            {"caption": f"{met} met, {missed} missed", "heads": HEADS, "rows": [cells(row) for row in found]},
            {"caption": "Where the time goes", "heads": ["part", "time"], "rows": profile},
        ],
    }
    asked.out.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def cells(row: Row) -> list[str]:
    """A row in words."""
    measured = "" if row.measured is None else f"{row.measured:.3g}"
    return [row.what, measured, row.words, row.verdict, row.detail]


def table(rows: list[Row]) -> Table:
    """What was measured beside what it should be."""
    made = Table(title="min / median / max stand in the last column", title_justify="left")
    for column in HEADS:
        made.add_column(column, justify="right" if column in ("measured", "target") else "left")
    for row in rows:
        style = {"missed": "bold red", "met": "green"}.get(row.verdict, "dim")
        what, measured, words, verdict, detail = cells(row)
        made.add_row(what, measured, words, f"[{style}]{verdict}[/]", detail)
    return made
