"""The progress bar of a run."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable
from contextlib import ExitStack

from numba.core import event
from rich.console import Console, RenderableType
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn

from .compiled import cache_folder

PATIENCE = 1.0
"""Seconds before a bar shows."""

COMPILING, KEPT = "compiling {what}: usually 5 to 20 s", ", kept for later runs"

STEP = "the step of this method"

PARTS = {
    "march": "the time loop", "judged": "what holds at faces", "shown": "slopes", "met": "face states",
    "sent": "fluxes", "settled": "friction", "transported": "transport of f", "pushed": "the force on f",
}  # fmt: skip
"""What the parts of a step are called on a bar."""


class Watched:
    """While it is open, a bar with the time left on the error stream; call it with the share that is done."""

    def __init__(self, quiet: bool = False) -> None:
        columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TaskProgressColumn())
        console = Console(stderr=True)
        off = quiet or not console.is_terminal
        self._tell_once = off and not quiet
        self._bar = _Late(*columns, TimeRemainingColumn(), console=console, transient=True, disable=off)
        self._task = self._bar.add_task("preparing", total=1.0)
        self._open = ExitStack()

    def __enter__(self) -> Watched:
        self._open.enter_context(event.install_listener("numba:compile", _Compiling(self._compiling)))
        self._bar.wait()
        self._open.enter_context(self._bar)
        return self

    def __exit__(self, *details: object) -> None:
        self._open.close()

    def tell(self, what: str, share: float) -> None:
        """Work on `what` has begun; `share` of the whole is done."""
        self._bar.update(self._task, completed=share, description=what)

    def __call__(self, share: float) -> None:
        self._bar.update(self._task, completed=share, description="running")

    def _compiling(self, part: str) -> None:
        """Without a bar it is told in a line, the first time."""
        kept = KEPT if cache_folder() else ""
        words = COMPILING.format(what=PARTS.get(part, STEP)) + kept if part else "preparing"
        self._bar.update(self._task, description=words)
        if self._tell_once:
            self._tell_once = False
            self._bar.console.print(COMPILING.format(what=STEP) + kept)


class _Late(Progress):
    """A bar that shows only when something takes a while."""

    begin = math.inf

    def wait(self) -> None:
        self.begin = time.monotonic() + PATIENCE

    def get_renderables(self) -> Iterable[RenderableType]:
        if time.monotonic() >= self.begin:
            yield from super().get_renderables()


class _Compiling(event.Listener):
    """Says so when numba compiles; what is found on disk is not compiled."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say, self._inside = say, 0

    def on_start(self, event: event.Event) -> None:
        self._inside += 1
        if self._inside == 1:  # what it calls is compiled on the way
            self._say(event.data["dispatcher"].__name__)

    def on_end(self, event: event.Event) -> None:
        self._inside -= 1
        if not self._inside:
            self._say("")
