"""The two tables of the page: moments of the half-ranges, and the ledger."""

from __future__ import annotations

import math
from html import escape

from ..books import COLUMNS, Books, stage_of
from ..cut import Cut, Half
from ..play import Stage

MINUS = "\N{MINUS SIGN}"


def moments_table(cut: Cut, misprinted: bool) -> str:
    """I1 to I4 as sums over what is shaded, in closed form, and, if wanted, as printed."""
    heads = ["", "", "shaded", "closed form", "difference", "bound"]
    rows = "".join(_moment(half, misprinted) for half in cut.halves)
    if misprinted:
        heads.append("as printed")
    head = "".join(f"<th>{name}</th>" for name in heads)
    return f'<table class="moments"><tr>{head}</tr>{rows}</table>'


def _moment(half: Half, misprinted: bool) -> str:
    bound = "none" if math.isnan(half.bound) else minus(f"{half.bound:.1e}")
    side = "left" if half.name.endswith(("1", "3")) else "right"
    cells = [
        f'<td><span class="swatch {side}"></span>{half.name}</td>',
        f"<td>{escape(half.told)}</td>",
        f"<td>{number(half.summed)}</td>",
        f"<td>{number(half.closed)}</td>",
        f"<td>{minus(f'{half.summed - half.closed:+.1e}')}</td>",
        f"<td>{bound}</td>",
    ]
    if misprinted:
        sign, word = ("✗", "wrong") if half.misprinted else ("✓", "right")
        cells.append(f'<td class="{word}">{number(half.printed)} {sign}</td>')
    return f'<tr data-moment="{half.name}">{"".join(cells)}</tr>'


def ledger_table(books: Books, stage: Stage | None) -> str:
    """The start, what each stage did so far, and what is now; the stage that is looked at is marked."""
    head = "".join(f"<th>{name}</th>" for name in ("", *COLUMNS))
    rows = [_row("at the start", books.start)]
    for cause, change in books.causes.items():
        rows.append(_row(cause, change, "here" if stage and stage_of(cause) == stage else "", signed=True))
    rows.append(_row("now", books.now, "total"))
    note = "rounding: " + ", ".join(minus(f"{value:.0e}") for value in books.unexplained) if books.causes else (
        "With order 2, and on smooth chutes, the stages are not booked one by one."
    )  # fmt: skip
    return f'<table class="ledger"><tr>{head}</tr>{"".join(rows)}</table><p class="note">{note}</p>'


def _row(name: str, values: object, css: str = "", signed: bool = False) -> str:
    cells = "".join(f"<td>{number(float(value), signed)}</td>" for value in values)  # type: ignore[attr-defined]
    return f'<tr class="{css}"><td>{escape(name)}</td>{cells}</tr>'


def number(value: float, signed: bool = False) -> str:
    """With six decimals, a true minus, and 0 for rounding."""
    if abs(value) < 5e-13:
        return "0"
    text = f"{value:+.6f}" if signed else f"{value:.6f}"
    if abs(value) < 1e-5 or abs(value) >= 1e6:
        text = f"{value:+.2e}" if signed else f"{value:.2e}"
    return minus(text)


def minus(text: str) -> str:
    """With true minus signs."""
    return text.replace("-", MINUS)
