"""The states that a run keeps, with their rows in the ledger."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..checkpoint import Kept, part, under
from ..clock import AnyClock, Courant
from ..errors import InputError
from ..memory import require_history
from .causes import Causes
from .ledger import Ledger
from .observer import Observer

if TYPE_CHECKING:
    from ..solver.solver import Block, Solver

ROWS = 100
"""A run of which nobody says how many states it is to keep keeps about so many."""


class Cadence:
    """When states are kept: after every so many steps, or at times on which steps land, or about `ROWS` times.

    Raises:
        InputError: More than one was asked for, or what was asked for makes no sense.
    """

    def __init__(
        self, clock: AnyClock, save_every: int | None, save_at: Sequence[float] | None, rows: int | None
    ) -> None:
        asked = {"save_every": save_every, "save_at": save_at, "rows": rows}
        given = [name for name, value in asked.items() if value is not None]
        if len(given) > 1:
            raise InputError(f"simulate: {' and '.join(given)} are given; give one of them")
        for name in ("save_every", "rows"):
            number = asked[name]
            if number is not None and (isinstance(number, bool) or not isinstance(number, (int, np.integer))):
                raise InputError(f"simulate: {name} = {number!r} is no whole number; take one, 1 or more")
            if isinstance(number, (int, np.integer)) and number < 1:
                raise InputError(f"{name} = {number} is below 1; take 1 or more")
        self.asked = {name: value for name, value in asked.items() if value is not None}
        self.every: int | None = None if save_every is None else int(save_every)
        self.times, self.past = np.empty(0), math.inf
        if save_at is not None:
            self.times = _times(save_at, clock.end)
            self.asked["save_at"] = self.times.tolist()
        elif rows is not None:
            self.times = np.append(clock.end * np.arange(1, rows) / rows, clock.end)
        elif save_every is None and isinstance(clock, Courant):
            self.past = clock.end / ROWS
        elif save_every is None and not isinstance(clock, Courant):
            self.every = max(math.ceil(clock.ticks / ROWS), 1)

    def count(self, steps: int) -> int:
        """How many rows a run of so many steps keeps."""
        if self.every:
            return math.ceil(steps / self.every) + 1
        return (self.times.size or min(ROWS, steps)) + 2


def _times(given: Sequence[float], end: float) -> Array:
    try:
        times = np.unique(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        raise InputError(f"save_at = {given!r:.60} is no list of times; write for example [0.5, 1.0]") from None
    if times.ndim != 1 or not times.size or not (np.isfinite(times) & (times >= 0.0) & (times <= end)).all():
        raise InputError(f"save_at: times lie between 0 and {end:g}, the end of the clock; got {given!r:.60}")
    return times[times > 0.0]


class History(Observer):
    """Keeps states, and what the ledger says of them.

    Attributes:
        ledger: The ledger.
        times, states: What was kept.
    """

    name = "history"

    def __init__(self, cadence: Cadence, ledger: Ledger, causes: Causes | None) -> None:
        self.cadence, self.ledger, self.causes = cadence, ledger, causes
        self.times: list[float] = []
        self.states: list[tuple[Array, Array]] = []
        self._foreseen = 0

    def foresee(self, steps: int, cells: int) -> None:
        """Refuse a run whose rows will not fit; it is foreseen to take so many steps."""
        kept = self._foreseen = self.cadence.count(steps)
        require_history(kept, steps, cells, f"{kept} rows and {steps} steps")

    def start(self, solver: Solver) -> None:
        self.ledger.start(solver)
        self._save(solver.t, solver.h, solver.q)

    def next_step(self, step: int) -> float:
        every = self.cadence.every
        return step + every - step % every if every else math.inf

    def next_time(self, t: float) -> float:
        later = self.cadence.times[self.cadence.times > t * (1.0 + 1e-12)]
        return float(later[0]) if later.size else math.inf

    def next_past(self, t: float) -> float:
        past = self.cadence.past
        return past * (math.floor(self.times[-1] / past * (1.0 + 1e-12)) + 1.0) if past < math.inf else math.inf

    def look(self, block: Block) -> str | None:
        self.ledger.note(block)
        if self._is_due(block) or block.last:
            more = len(self.states)
            if more > self._foreseen and more & (more - 1) == 0:  # twice as many may come before the next look
                require_history(more, block.step, block.h.size, f"{more} rows more")
            self.save(block)
        return None

    def _is_due(self, block: Block) -> bool:
        cadence = self.cadence
        if cadence.every:
            return block.step % cadence.every == 0
        if cadence.past < math.inf:
            return block.t >= self.next_past(block.t)
        return bool(np.any(cadence.times == block.t))

    def save(self, block: Block) -> None:
        """Keep the state after a block."""
        if self.times[-1] == block.t:
            return
        self.ledger.save(block)
        self._save(block.t, block.h, block.q)

    def _save(self, t: float, h: Array, q: Array) -> None:
        self.times.append(t)
        self.states.append((h.copy(), q.copy()))
        if self.causes:
            self.causes.save(t, h, q)

    def kept(self) -> Kept:
        own = {"times": np.array(self.times), "states": np.array(self.states)}
        return own | under("ledger", self.ledger.kept())

    def restore(self, kept: Kept) -> None:
        self.times = kept["times"].tolist()
        self.states = [(h, q) for h, q in kept["states"]]
        self.ledger.restore(part("ledger", kept))
