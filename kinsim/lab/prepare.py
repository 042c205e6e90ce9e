"""Plays are made aside: kernels that nobody used before on this machine compile for seconds."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from threading import Thread

from ..read import SceneFile
from .books import Ledger
from .cut import cut_at, faces_of
from .play import STAGES, Play

_compiled: set[tuple[object, ...]] = set()


def make(file: SceneFile) -> Play:
    """A play that is ready to go; the first one of its kind in this process takes a step that nobody sees."""
    method, scene = file.method, file.scene
    kind = (*(getattr(method, name, None) for name in ("scheme", "coupling", "order", "equilibrium", "force")),
            scene.forced, scene.boundary, scene.friction.kind)  # fmt: skip
    if kind not in _compiled:
        rehearsal = Play(file)
        for _ in STAGES:
            rehearsal.next_stage()
            for states in faces_of(rehearsal.method):
                cut_at(rehearsal, rehearsal.moment(), 0, states)
        Ledger(rehearsal).books()
        _compiled.add(kind)
    return Play(file)


def make_aside(file: SceneFile, done: Callable[[Future[Play]], None]) -> None:
    """The same in a thread that nobody waits for when the command ends; `done` gets it there."""
    made: Future[Play] = Future()
    made.add_done_callback(done)

    def work() -> None:
        try:
            made.set_result(make(file))
        except Exception as error:
            made.set_exception(error)

    Thread(target=work, daemon=True, name="kinsim-lab").start()
