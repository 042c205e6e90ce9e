"""Ctrl-C and SIGTERM: alike, and within the time loop between two steps, never within one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType, TracebackType
from typing import TYPE_CHECKING, Any, Self

if TYPE_CHECKING:
    from .run import Run


class Deferred:
    """While open, the first Ctrl-C or SIGTERM only sets `asked`; a second one interrupts at once, as usual.

    Outside the main thread, where no signals arrive, nothing is changed.
    """

    def __init__(self) -> None:
        self.asked = False
        self._usual: dict[int, Any] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            self._usual = {number: signal.signal(number, self._note) for number in (signal.SIGINT, signal.SIGTERM)}
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        for number, usual in self._usual.items():
            signal.signal(number, usual)

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True


@contextmanager
def terminable() -> Iterator[None]:
    """While open, SIGTERM interrupts as Ctrl-C does; outside the main thread nothing is changed."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    usual = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, usual)


def unless_interrupted(run: Run) -> Run:
    """`run`; what interrupted it interrupts who asked for it, too.

    Raises:
        KeyboardInterrupt: It was interrupted.
    """
    if run.verdict.kind == "interrupted":
        raise KeyboardInterrupt
    return run
