"""All that a moment shows: five pictures and the words beside them."""

from __future__ import annotations

import time
from html import escape
from typing import Any

from ..books import Ledger
from ..cut import Cut, FaceStates, cut_at
from ..picture import steepest
from ..play import Moment, Play
from ..told import passing, told
from .charts import Curve, Density, History, Slice
from .tables import ledger_table, minus, moments_table
from .widgets import Widgets

WRITTEN = 0.25
"""Seconds between two looks at the numbers while it plays; nobody reads them at the pace of pictures."""


class Painter:
    """The pictures of one page, and the place that was clicked."""

    def __init__(self, widgets: Widgets) -> None:
        self._widgets = widgets
        self._density, self._slice, self._history = Density(), Slice(), History()
        self._height, self._velocity = Curve("h", "height h"), Curve("u", "velocity u", x_axis_label="x")
        self._charts: dict[str, Density | Curve | Slice | History] = {
            "density": self._density, "height": self._height, "velocity": self._velocity, "slice": self._slice,
            "history": self._history,
        }  # fmt: skip
        self._place: float | None = None
        self._cell, self._written = 0, 0.0
        self.said = ""

    @property
    def figures(self) -> dict[str, Any]:
        """By their place on the page."""
        return {name: chart.figure for name, chart in self._charts.items()}

    def begin(self, play: Play) -> None:
        """Make room for a new run."""
        moment = play.moment()
        self._ledger = Ledger(play)
        self._cell = steepest(moment) if self._place is None else _cell_at(play, self._place)
        for chart in self._charts.values():
            chart.begin(play, moment)

    def choose(self, play: Play, x: float) -> None:
        """Cut at a place, in this run and in those that come."""
        self._place, self._cell = x, _cell_at(play, x)

    def forget(self) -> None:
        """Cut where the next run is steepest."""
        self._place = None

    def show(self, play: Play, states: FaceStates, printed: bool, words: bool, rate: float) -> None:
        """Draw where the run stands; the words only if asked for, or when they are old."""
        moment = play.moment()
        cut = cut_at(play, moment, self._cell, states)
        self._slice.show(cut)
        for chart in (self._height, self._velocity, self._density):
            chart.show(play, moment, cut)
        now = time.perf_counter()
        if words or now - self._written > WRITTEN:
            self._written = now
            self._tell(play, moment, cut, printed, rate)

    def say(self, line: str, css: str = "") -> None:
        """A sentence to the user, in place of the one before."""
        self.said = line
        self._write("told", f'<div class="say {css}">{escape(line)}</div>' if line else "")

    def _tell(self, play: Play, moment: Moment, cut: Cut, printed: bool, rate: float) -> None:
        books = self._ledger.books()
        self._history.show(moment, books)
        self._write(
            "scale", f'<span class="bar">0 <i></i> {self._density.top:.2g}, <b>orange</b> where f &lt; 0</span>'
        )
        self._write("moments", moments_table(cut, printed))
        self._write("passing", f'<p class="note">{passing(play, moment, cut.cell)}</p>')
        self._write("books", ledger_table(books, moment.stage if moment.step else None))
        places = minus(f"Cut at x = {cut.x:.3g}, and its wall at {cut.face_x:.3g}")
        self._write("cut-title", f"<h2>{places} <small>click above for another cell</small></h2>")
        self._write("stage-told", f'<p class="stage">{minus(told(moment, play.method, play.scene.forced))}</p>')
        pace = f" &nbsp; {rate:.0f} pictures/s" if rate else ""
        now = f"t = <b>{moment.t:.3f}</b> &nbsp; step <b>{moment.step}</b>{pace}"
        self._widgets.where.object = f'<span class="now">{now}</span>'

    def _write(self, name: str, html: str) -> None:
        self._widgets.texts[name].object = html


def _cell_at(play: Play, x: float) -> int:
    cells = play.scene.cells
    return min(max(int((x - cells.left) / cells.dx), 0), cells.count - 1)
