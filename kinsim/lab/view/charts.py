"""The pictures of the page. Each has a source whose columns are replaced; nothing is drawn anew from the start."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, LinearColorMapper, Range1d, Span
from bokeh.palettes import Viridis256
from bokeh.plotting import figure

from ...arrays import Array
from ..books import COLUMNS, Books
from ..cut import Cut
from ..picture import image_of, peak_of, span
from ..play import Moment, Play

BLUE, ORANGE, BLACK, SKY, AMBER, PINK, GREEN = (
    "#0072b2", "#d55e00", "#111111", "#56b4e9", "#e69f00", "#cc79a7", "#009e73"
)  # fmt: skip
"""Okabe and Ito's colours for the colour-blind; dashes tell lines apart without colour."""

ROOM = 1.15
"""Of what outgrows the colours."""

HISTORY = 4000
"""Rows of the ledger's curves that the page keeps."""


class Density:
    """f(x, xi) as a picture with the edges of its support."""

    def __init__(self) -> None:
        self._image = ColumnDataSource(
            {"image": [np.zeros((2, 2), np.float32)], "x": [0], "y": [0], "dw": [1], "dh": [1]}
        )
        self._image.name = "picture of f"
        self._edges = ColumnDataSource({name: [] for name in ("x", "low", "mean", "high")})
        self._mapper = LinearColorMapper(Viridis256, low=0.0, high=1.0, low_color=ORANGE, nan_color="white")
        self.figure = plain(x_axis_label="x", y_axis_label="particle velocity ξ")
        self.figure.image("image", x="x", y="y", dw="dw", dh="dh", color_mapper=self._mapper, source=self._image)
        edge = {"source": self._edges, "color": "white", "line_width": 1.6}
        for name in ("low", "high"):
            self.figure.line("x", name, **edge)
        self.figure.line("x", "mean", line_dash="dotted", **edge)
        self.marker = marker(self.figure)

    def begin(self, play: Play, moment: Moment) -> None:
        """Fit the axes to a run."""
        cells, bound = play.scene.cells, play.density.grid.bound
        frame(self.figure, (cells.left, cells.right), (-bound, bound))
        self._mapper.high = 1.02 * peak_of(play, moment) or 1.0

    @property
    def top(self) -> float:
        """The density of the brightest colour."""
        return float(self._mapper.high)

    def show(self, play: Play, moment: Moment, cut: Cut) -> None:
        """Draw a moment."""
        grid, cells = play.density.grid, play.scene.cells
        c = np.sqrt(2.0 * play.scene.beta * np.maximum(moment.h, 0.0))
        u = moment.u
        self._edges.data = {"x": play.scene.x, "low": u - c, "mean": u, "high": u + c}
        self.marker.location = cut.x
        if (top := float(moment.f.max())) > self._mapper.high:
            self._mapper.high = ROOM * top
        self._image.data = {
            "image": [image_of(moment, grid)], "x": [cells.left], "y": [-grid.bound],
            "dw": [cells.right - cells.left], "dh": [2.0 * grid.bound],
        }  # fmt: skip


class Curve:
    """Height or velocity over x, beside the twin and the exact solution."""

    def __init__(self, name: str, label: str, **axes: Any) -> None:
        self._name = name
        columns = ("x", "own", "twin", "exact")
        self._source = ColumnDataSource({column: [] for column in columns}, name=label)
        self.figure = plain(y_axis_label=label, **axes)
        shown = {"source": self._source, "x": "x"}
        self.figure.line(y="exact", color=BLACK, line_width=1.4, line_dash="dotted", **shown)
        self.figure.line(y="own", color=BLUE, line_width=2.4, **shown)
        self.figure.line(y="twin", color=ORANGE, line_width=1.6, line_dash=[7, 5], **shown)
        self.marker = marker(self.figure)

    def begin(self, play: Play, moment: Moment) -> None:
        """Fit the axes to a run."""
        cells = play.scene.cells
        bound = 0.5 * play.density.grid.bound
        frame(
            self.figure,
            (cells.left, cells.right),
            span(self._own(moment), least=0.5) if self._name == "h" else (-bound, bound),
        )

    def show(self, play: Play, moment: Moment, cut: Cut) -> None:
        """Draw a moment; the axis grows when it has to."""
        own, twin = self._own(moment), getattr(moment, f"twin_{self._name}")
        known = getattr(moment, f"exact_{self._name}")
        exact = np.full_like(own, np.nan) if known is None else known
        self._source.data = {"x": play.scene.x, "own": own, "twin": twin, "exact": exact}
        self.marker.location = cut.x
        grow(self.figure, own, twin, exact)

    def _own(self, moment: Moment) -> Array:
        values: Array = getattr(moment, self._name)
        return values


class Slice:
    """The cut f(xi) beside M, and the two half-ranges at the face shaded."""

    def __init__(self) -> None:
        none = [0.0, 0.0]  # for a browser draws steps of no points forever
        self._sides = [ColumnDataSource({name: none for name in ("xi", "zero", "top")}) for _ in range(2)]
        self._steps = ColumnDataSource({"xi": none, "f": none})
        self._curve = ColumnDataSource({"xi": [], "M": []})
        self.figure = plain(x_axis_label="particle velocity ξ", y_axis_label="density")
        for source, colour in zip(self._sides, (AMBER, SKY), strict=True):
            self.figure.varea_step("xi", "zero", "top", source=source, step_mode="after", color=colour, alpha=0.6)
        self.figure.step("xi", "f", source=self._steps, mode="after", color=BLUE, line_width=2.2)
        self.figure.line("xi", "M", source=self._curve, color=BLACK, line_width=1.3)
        self.figure.add_layout(Span(location=0, dimension="height", line_color="#777777", line_width=1))

    def begin(self, play: Play, moment: Moment) -> None:
        """Fit the axes to a run."""
        bound = play.density.grid.bound
        frame(self.figure, (-bound, bound), (0.0, 1.08 * peak_of(play, moment) or 1.0))

    def show(self, cut: Cut) -> None:
        """Draw a cut."""
        half = cut.face.size // 2
        sides = (cut.face_edges[: half + 1], cut.face[:half]), (cut.face_edges[half:], cut.face[half:])
        for source, (edges, face) in zip(self._sides, sides, strict=True):
            source.data = {"xi": edges, "zero": np.zeros(half + 1), "top": np.append(face, face[-1])}
        self._steps.data = {"xi": cut.edges, "f": np.append(cut.f, 0.0)}
        self._curve.data = {"xi": cut.xi, "M": cut.M}
        grow(self.figure, cut.f, cut.face)


class History:
    """Mass, momentum and entropy less what they were at the start, over time."""

    def __init__(self) -> None:
        self._source = ColumnDataSource({name: [] for name in ("t", *COLUMNS)})
        self.figure = plain(x_axis_label="time t", y_axis_label="change")
        looks = zip(COLUMNS, (GREEN, BLUE, ORANGE), ("solid", "dashed", "dotdash"), strict=True)
        for name, colour, dash in looks:
            self.figure.line("t", name, source=self._source, color=colour, line_dash=dash, line_width=2)
        self.figure.x_range, self._t = Range1d(0.0, 1.0), -1.0

    def begin(self, play: Play, moment: Moment) -> None:
        """Start anew."""
        self._source.data = {name: [] for name in ("t", *COLUMNS)}
        self.figure.x_range.end = play.end
        self.figure.y_range.start, self.figure.y_range.end = -0.05, 0.05
        self._t = -1.0

    def show(self, moment: Moment, books: Books) -> None:
        """Add a row, after a whole step."""
        if moment.t <= self._t:
            return
        self._t = moment.t
        change = books.now - books.start
        row = {name: [value] for name, value in zip(COLUMNS, change.tolist(), strict=True)}
        self._source.stream({"t": [moment.t], **row}, rollover=HISTORY)
        grow(self.figure, change)


def plain(**axes: Any) -> Any:
    """A figure without tools that only a tap reaches."""
    made = figure(
        toolbar_location=None, tools="tap", sizing_mode="stretch_both", min_height=90, output_backend="canvas",
        x_range=Range1d(0, 1), y_range=Range1d(0, 1), **axes,
    )  # fmt: skip
    made.background_fill_color, made.border_fill_color, made.outline_line_color = "white", "white", "#cccccc"
    made.xgrid.grid_line_alpha = made.ygrid.grid_line_alpha = 0.5
    made.xaxis.visible = "x_axis_label" in axes
    for axis in (*made.xaxis, *made.yaxis):
        axis.axis_label_text_font_style, axis.axis_label_text_font_size = "normal", "13px"
        axis.major_label_text_font_size, axis.axis_label_standoff = "12px", 4
        axis.minor_tick_line_color = None
    made.min_border_right, made.min_border_left, made.min_border_top = 12, 58, 6
    return made


def marker(chart: Any) -> Span:
    """Where the cut is."""
    span = Span(location=0, dimension="height", line_color=PINK, line_dash="dashed", line_width=2)
    chart.add_layout(span)
    return span


def frame(chart: Any, x: tuple[float, float], y: tuple[float, float]) -> None:
    """Set the ranges."""
    chart.x_range.start, chart.x_range.end = x
    chart.y_range.start, chart.y_range.end = y


def grow(chart: Any, *values: Array) -> None:
    """Widen the y-axis where a value would leave it."""
    low, high = chart.y_range.start, chart.y_range.end
    least, most = (
        float(np.nanmin([np.nanmin(v, initial=np.inf) for v in values])),
        float(np.nanmax([np.nanmax(v, initial=-np.inf) for v in values])),
    )
    room = 0.15 * max(most - least, high - low)
    if np.isfinite(most) and most > high:
        chart.y_range.end = most + room
    if np.isfinite(least) and least < low:
        chart.y_range.start = least - room
