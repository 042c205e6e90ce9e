"""One page of the lab: widgets, pictures and a run of its own, for one browser tab."""

from __future__ import annotations

import io
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

import panel as pn
from bokeh.events import ConnectionLost, Tap
from bokeh.models import CustomJS
from panel.io.document import unlocked
from tornado.ioloop import IOLoop

from ...errors import InputError, line_of
from ...read import built_in
from ...run import ENDED
from ..cut import faces_of
from ..play import Play
from ..prepare import make_aside
from ..setup import Setup
from .controls import Controls
from .pace import Pace
from .painter import Painter
from .widgets import PAUSE, PLAY, Widgets

BUDGET = 0.04
"""Seconds of steps from one picture to the next, at most."""

PATIENCE = 300
"""Milliseconds after which a run that is still being made gets a word."""

COMPILING = "Compiling the kernels of this method; that takes up to half a minute, once on this machine …"


class Page:
    """What one browser tab shows; nothing of it is shared with another."""

    def __init__(self, start: Setup) -> None:
        self._doc: Any = pn.state.curdoc
        self._loop = IOLoop.current()
        self._setup = self._origin = start
        self._setups = {start.name: start}
        self._play: Play | None = None
        self._wanted: Setup | None = None
        self._asked: list[Callable[[Play], bool]] = []
        self._busy = self._gone = False
        self._pace = Pace(self._pump)
        self._widgets = Widgets(list(dict.fromkeys([start.name, *built_in()])), start.name, self._file)
        self._painter = Painter(self._widgets)
        self._controls = Controls(self._turn)
        self._connect()
        self.take(start)

    def template(self) -> Any:
        """The page with all its parts in place."""
        return self._widgets.template(self._controls.column, self._painter.figures)

    def take(self, setup: Setup) -> None:
        """Run what a setup says, from its start; where it is refused say why, and keep the last run on the page."""
        self._setup, self._asked = setup, []
        self._controls.fit(setup)
        self._allow(not setup.refusal)
        if setup.refusal:
            self._painter.say(setup.refusal, "fault")
            return
        self._wanted = setup
        self._painter.say(" ".join(setup.notes))
        self._doc.add_timeout_callback(self._still_busy, PATIENCE)
        self._prepare()

    def _connect(self) -> None:
        """Let widgets and pictures act."""
        w = self._widgets
        figures = self._painter.figures
        figures["density"].tags = [self._pace.ticket]  # so that the document holds it
        for name in ("density", "height", "velocity"):
            figures[name].on_event(Tap, self._tapped)
        for widget, act in (
            (w.scene, self._named), (w.play, self._played), (w.stage, self._looked),
            (w.printed, lambda value: self.draw()), (w.faces, lambda value: self.draw()),
        ):  # fmt: skip
            widget.param.watch(lambda event, act=act: act(event.new), "value")
        w.load.param.watch(
            lambda *events: self._loaded(w.load.value or b"", str(w.load.filename)), ["value", "filename"]
        )
        w.step.on_click(lambda event: self._by_hand(Play.advance))
        w.next_stage.on_click(lambda event: self._by_hand(Play.next_stage))
        w.over.on_click(lambda event: self.take(self._setup))
        w.reset.on_click(lambda event: self._restart())
        self._doc.js_on_event(ConnectionLost, CustomJS(code='document.body.classList.add("lost")'))
        pn.state.on_session_destroyed(self._left)

    def draw(self) -> None:
        """Show where the run stands, in one message, so that the browser paints once."""
        play, w = self._play, self._widgets
        if play is None or self._gone:
            return
        with unlocked():
            rate = self._pace.rate if w.play.value else 0.0
            self._painter.show(play, w.states, w.printed.value, not w.play.value, rate)
            self._pace.send()

    def _prepare(self) -> None:
        """Make the run that is wanted, one at a time, and none that is out of date."""
        if self._busy or self._wanted is None:
            return
        setup, self._wanted, self._busy = self._wanted, None, True

        def later(made: Future[Play]) -> None:
            self._doc.add_next_tick_callback(lambda: self._ready(setup, made))

        # by way of the loop, for a document that is still being made loses what another thread hands to it
        make_aside(setup.file, lambda made: self._loop.add_callback(later, made))

    def _still_busy(self) -> None:
        notes = " ".join(self._setup.notes)
        if self._busy and not self._gone and self._painter.said == notes:
            self._painter.say(f"{notes} {COMPILING}".strip(), "busy")

    def _ready(self, setup: Setup, made: Future[Play]) -> None:
        """A run is there, or could not be made."""
        self._busy = False
        if self._gone:
            return
        if self._wanted is not None:
            self._prepare()
            return
        try:
            play = made.result()
        except (InputError, MemoryError) as error:
            self._asked = []
            self._allow(False)
            self._fault(error)
            return
        if COMPILING in self._painter.said:
            self._painter.say(" ".join(setup.notes))
        play.stage = self._widgets.stage.value
        self._play = play
        with unlocked():
            self._painter.begin(play)
        self._widgets.offer(faces_of(play.method))
        for way in self._asked:
            self._go(play, way)
        self._asked = []
        self._widgets.stage.value = play.stage
        self.draw()

    def _pump(self) -> None:
        """Take the next steps and draw, if the browser has painted the last picture and it is time."""
        play = self._play
        if self._gone or not self._widgets.play.value or play is None or self._busy or not self._pace.free:
            return
        if (rest := self._pace.rest) > 0.0:
            self._doc.add_timeout_callback(self._pump, max(1, int(1e3 * rest)))
            return
        begun = time.perf_counter()
        for _ in range(self._widgets.pace.value):
            if not self._go(play, Play.advance):
                break
            if time.perf_counter() - begun > BUDGET:
                break
        self.draw()
        if self._pace.free:
            self._doc.add_next_tick_callback(self._pump)

    def _go(self, play: Play, way: Callable[[Play], bool]) -> bool:
        """Go on by a step or a stage; tell how a run ended."""
        try:
            if way(play):
                return True
        except (InputError, MemoryError) as error:
            self._fault(error)
        self._halt()
        if play.verdict is not None:
            good = play.verdict.kind in ENDED
            self._painter.say(f"The run is over: {play.verdict}.", "" if good else "fault")
        return False

    def _halt(self) -> None:
        self._widgets.play.value = False

    def _played(self, on: bool) -> None:
        self._widgets.play.name = PAUSE if on else PLAY
        self._pace.restart()
        if on:
            self._pump()
        else:
            self.draw()

    def _by_hand(self, way: Callable[[Play], bool]) -> None:
        self._halt()
        if self._busy:
            self._asked.append(way)
        elif self._play is not None:
            self._go(self._play, way)
            self._widgets.stage.value = self._play.stage
            self.draw()

    def _looked(self, stage: Any) -> None:
        if self._play is not None and not self._busy and self._play.stage != stage:
            self._play.stage = stage
            self.draw()

    def _tapped(self, event: Any) -> None:
        if self._play is not None and event.x is not None:
            self._painter.choose(self._play, event.x)
            self.draw()

    def _turn(self, key: str, given: Any) -> None:
        try:
            self.take(self._setup.turned(key, given))
        except InputError as error:
            self._fault(error)

    def _named(self, name: str) -> None:
        """A scene was chosen: a built-in one, or a file that was opened."""
        try:
            self._origin = self._setups.get(name) or Setup.of_scene(name)
        except InputError as error:
            self._fault(error)
            return
        self._restart()

    def _restart(self) -> None:
        """As the scene or the file says, and cut where it is steepest."""
        self._painter.forget()
        self.take(self._origin)

    def _loaded(self, content: bytes, name: str) -> None:
        scene = self._widgets.scene
        try:
            self._setups[name] = Setup.of_content(content, name)
        except InputError as error:
            self._fault(error)
            return
        if scene.value == name:
            self._named(name)
        else:
            scene.options = list(dict.fromkeys([name, *scene.options]))
            scene.value = name

    def _file(self) -> io.BytesIO:
        return io.BytesIO(self._setup.toml().encode("utf-8"))

    def _fault(self, error: Exception) -> None:
        self._painter.say(line_of(error), "fault")

    def _allow(self, run: bool) -> None:
        """Let the setting be run, or keep the last run on the page, but not as that of this setting."""
        for widget in self._widgets.runs:
            widget.disabled = not run
        if not run:
            self._halt()

    def _left(self, context: Any) -> None:
        """The tab is gone, and with it all that it showed."""
        self._gone = True
        self._play = self._wanted = None
