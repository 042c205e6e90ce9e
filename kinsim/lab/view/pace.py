"""No picture is sent before the browser has painted the one before."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from bokeh.models import ColumnDataSource, CustomJS

LEAST = 1.0 / 30.0
"""Seconds between two pictures, at least."""

PAINTED = """
requestAnimationFrame(() => requestAnimationFrame(() => { painted.data = {number: [cb_obj.data.number[0]]} }))
"""
"""The browser says which picture it has painted; a hidden tab paints none, and so the run waits for it."""


class Pace:
    """Counts pictures on their way; `painted` is called when one has arrived.

    Attributes:
        ticket: Goes along with a picture; some figure must hold it.
    """

    def __init__(self, painted: Callable[[], None]) -> None:
        self._sent = self._seen = 0
        self._at = 0.0
        self._times: deque[float] = deque(maxlen=20)
        self._call = painted
        self.ticket, back = ColumnDataSource({"number": [0]}), ColumnDataSource({"number": [0]}, name="painted")
        self.ticket.js_on_change("data", CustomJS(args={"painted": back}, code=PAINTED))
        back.on_change("data", lambda name, old, new: self._painted(new["number"][0]))

    @property
    def free(self) -> bool:
        """Whether the browser waits for a picture."""
        return self._seen >= self._sent

    @property
    def rest(self) -> float:
        """Seconds until the next picture may be sent."""
        return self._at + LEAST - time.perf_counter()

    @property
    def rate(self) -> float:
        """Pictures painted in a second, or 0 while too few were."""
        seen = self._times
        return (len(seen) - 1) / (seen[-1] - seen[0]) if len(seen) > 4 else 0.0

    def send(self) -> None:
        """A picture is on its way."""
        self._sent += 1
        self._at = time.perf_counter()
        self.ticket.data = {"number": [self._sent]}

    def restart(self) -> None:
        """Wait for none, and count anew."""
        self._times.clear()
        self._seen = self._sent

    def _painted(self, number: int) -> None:
        self._seen = number
        self._times.append(time.perf_counter())
        self._call()
