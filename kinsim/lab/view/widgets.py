"""Buttons, switches and texts of the page, and where they stand on it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import panel as pn

from ..cut import FACES, FaceStates
from ..play import STAGES

TEMPLATE, SHEET = ((Path(__file__).parent / name).read_text(encoding="utf-8") for name in ("page.html", "page.css"))

WIDE: dict[str, Any] = {"sizing_mode": "stretch_width"}

PLAY, PAUSE = "▶ Play", "❚❚ Pause"


class Widgets:
    """All of them; `file` makes the scene file that is saved."""

    def __init__(self, scenes: Sequence[str], scene: str, file: Callable[[], Any]) -> None:
        self.scene = pn.widgets.Select(
            name="scene", options=list(scenes), value=scene, css_classes=["scene"], margin=(6, 2, 0, 10), **WIDE
        )
        self.reset = button("Reset", "reset", 62, align="end", margin=(4, 10, 0, 2), height=32)
        self.save = pn.widgets.FileDownload(
            label="Save as scene file", filename="scene.toml", callback=file, embed=False, auto=True,
            css_classes=["save"], margin=(0, 10), height=32, width=150,
        )  # fmt: skip
        self.load = pn.widgets.FileInput(accept=".toml", css_classes=["load"], margin=(2, 4), width=250, height=30)
        self.play = pn.widgets.Toggle(
            name=PLAY, button_type="primary", width=92, css_classes=["play"], margin=(4, 3), height=34
        )
        self.step = button("Step", "one", 64)
        self.next_stage = button("Next stage", "next", 94)
        self.over = button("↺ Start over", "over", 104)
        self.stage = pn.widgets.RadioButtonGroup(
            options={f"{k + 1} {name}": name for k, name in enumerate(STAGES)}, value="force", css_classes=["stage"],
            margin=(4, 3), height=34,
        )  # fmt: skip
        self.pace = pn.widgets.IntSlider(
            name="steps per picture", start=1, end=20, value=1, width=120, margin=(0, 10), css_classes=["pace"]
        )
        self.printed = pn.widgets.Checkbox(
            name="beside the paper's formulas as printed", margin=(2, 10), css_classes=["printed"]
        )
        self.faces = pn.widgets.Select(width=170, margin=(0, 6), css_classes=["faces"])
        self.where = text("where", margin=(0, 8), sizing_mode="fixed", width=236, height=24)
        names = ("told", "stage-told", "moments", "passing", "books", "cut-title", "scale")
        self.texts = {name: text(name) for name in names}

    @property
    def runs(self) -> list[Any]:
        """Those that need a setting which can be run."""
        return [self.play, self.step, self.next_stage, self.over, self.save]

    def offer(self, faces: Sequence[FaceStates]) -> None:
        """Let these faces be chosen; where others can be than so far, the first is."""
        labels = [FACES[states] for states in faces]
        if labels != self.faces.options:
            self.faces.param.update(options=labels, value=labels[0])

    @property
    def states(self) -> FaceStates:
        """Those of the faces that are chosen."""
        return next(states for states, label in FACES.items() if label == self.faces.value)

    def template(self, knobs: Any, charts: Mapping[str, Any]) -> Any:
        """The page with all its parts in place."""
        page = pn.Template(TEMPLATE)
        bar = (self.play, self.step, self.next_stage, self.over, self.stage, self.pace, self.where)
        opened = pn.pane.HTML("open one:", margin=(7, 0, 0, 6))
        parts = {
            "files": pn.Row(self.save, opened, self.load, margin=0),
            "knobs": pn.Column(pn.Row(self.scene, self.reset, margin=0, **WIDE), knobs, **WIDE),
            "bar": pn.FlexBox(*bar, align_items="center", **WIDE),
            "switches": pn.FlexBox(self.faces, self.printed, align_items="center"),
            **{name.replace("-", "_"): pane for name, pane in self.texts.items()},
            **{name: pn.pane.Bokeh(figure, sizing_mode="stretch_both", margin=0) for name, figure in charts.items()},
        }
        for name, part in parts.items():
            page.add_panel(name, part)
        page.add_variable("title", "kinsim lab")
        return page


def button(label: str, css: str, width: int, **look: Any) -> Any:
    """A button that can be found by its class."""
    return pn.widgets.Button(name=label, width=width, css_classes=[css], **{"margin": (4, 3), "height": 34, **look})


def text(name: str, **look: Any) -> Any:
    """A piece of the page that is written anew."""
    return pn.pane.HTML("", css_classes=[name], stylesheets=[SHEET], **{"margin": 0, **WIDE, **look})
