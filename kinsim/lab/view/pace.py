"""No more pictures are on their way than the one that the browser paints and the next one."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

from bokeh.models import ColumnDataSource, CustomJS

LEAST = 1.0 / 30.0
"""Seconds between two pictures, at least."""

AHEAD = 2
"""Pictures on their way, at most: while the browser paints one, the next is made."""

PAINTED = """
const number = cb_obj.data.number[0]
requestAnimationFrame(() => requestAnimationFrame(now => {
  const {frames, at} = painted.data
  painted.data = {number: [number], frames: [frames[0] + (now > at[0])], at: [now]}
}))
"""
"""The browser says which picture it has painted, and how many frames that took: two that it painted at once are one.

A hidden tab paints none, and so the run waits for it.
"""


class Pace:
    """Counts pictures on their way; `painted` is called when one has arrived.

    Attributes:
        ticket: Goes along with a picture; some figure must hold it.
    """

    def __init__(self, painted: Callable[[], None]) -> None:
        self._sent = self._seen = self._frames = 0
        self._at = 0.0
        self._times: deque[float] = deque(maxlen=20)
        self._call = painted
        self.ticket = ColumnDataSource({"number": [0]})
        back = ColumnDataSource({"number": [0], "frames": [0], "at": [0.0]}, name="painted")
        self.ticket.js_on_change("data", CustomJS(args={"painted": back}, code=PAINTED))
        back.on_change("data", lambda name, old, new: self._painted(new["number"][0], new["frames"][0]))

    @property
    def free(self) -> bool:
        """Whether another picture may be made."""
        return self._sent - self._seen < AHEAD

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

    def _painted(self, number: int, frames: int) -> None:
        self._seen = max(number, self._seen)
        if frames > self._frames:
            self._frames = frames
            self._times.append(time.perf_counter())
        self._call()
