"""The widgets that turn the knobs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn

from ...errors import InputError
from ..knobs import Choice, Knob, Slider, knobs_of
from ..setup import Setup

Turn = Callable[[str, Any], None]


class Controls:
    """A column of widgets, made anew when a scene or a scheme brings other knobs."""

    def __init__(self, turn: Turn) -> None:
        self._turn = turn
        self._widgets: dict[str, tuple[Knob, Any]] = {}
        self._quiet = False
        self.column = pn.Column(sizing_mode="stretch_width", margin=0)

    def fit(self, setup: Setup) -> None:
        """Show what `setup` says; one that is refused keeps the knobs as they are."""
        if setup.refusal:
            return
        groups = knobs_of(setup.file)
        keys = [knob.key for knobs in groups.values() for knob in knobs]
        self._quiet = True
        try:
            if keys != list(self._widgets):
                self._build(groups, setup)
            for knob, widget in self._widgets.values():
                _put(knob, widget, setup.given(knob.key))
        finally:
            self._quiet = False

    def _build(self, groups: dict[str, list[Knob]], setup: Setup) -> None:
        self._widgets = {}
        parts: list[Any] = []
        for title, knobs in groups.items():
            if not knobs:
                continue
            parts.append(pn.pane.HTML(f"<b>{title}</b>", margin=(8, 10, 0, 10), height=20, sizing_mode="stretch_width"))
            for knob in knobs:
                widget = _widget(knob, setup)
                widget.param.watch(lambda event, knob=knob: self._moved(knob, event), "value")
                self._widgets[knob.key] = (knob, widget)
                parts.append(widget)
        self.column.objects = parts

    def _moved(self, knob: Knob, event: Any) -> None:
        """What is moved turns its knob, but not the widget of a scene before, whose last move comes late."""
        if self._quiet or self._widgets.get(knob.key, (knob, None))[1] is not event.obj:
            return
        self._turn(knob.key, knob.given(event.new) if isinstance(knob, Slider) else event.new)


def _widget(knob: Knob, setup: Setup) -> Any:
    css = [f"knob-{knob.key.replace('.', '-')}"]
    look: dict[str, Any] = {"sizing_mode": "stretch_width", "margin": (3, 10, 3, 10), "css_classes": css}
    if isinstance(knob, Choice):
        return pn.widgets.Select(name=knob.label, options=knob.options, description=knob.told, **look)
    kind = pn.widgets.IntSlider if knob.whole else pn.widgets.FloatSlider
    try:
        shown = knob.shown(setup.given(knob.key))
    except InputError:
        shown = knob.low
    bounds: dict[str, Any] = {"start": min(knob.low, shown), "end": max(knob.high, shown), "step": knob.step}
    if not knob.whole:
        bounds["format"] = "0[.]000"
    return kind(name=knob.label, value=shown, **bounds, **look)


def _put(knob: Knob, widget: Any, given: Any) -> None:
    """Let a widget show a value; a slider reaches as far as that."""
    shown = knob.shown(given) if isinstance(knob, Slider) else given
    if isinstance(knob, Slider) and not widget.start <= shown <= widget.end:
        widget.param.update(start=min(widget.start, shown), end=max(widget.end, shown))
    if widget.value != shown:
        widget.value = shown
