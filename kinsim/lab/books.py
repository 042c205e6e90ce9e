"""The running ledger: mass, momentum and entropy at the start, what each stage did to them, and what they are now."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..diagnostics.causes import STAGES
from ..measure.entropy import of_state
from .play import Play

COLUMNS = ("mass", "momentum", "entropy")
"""Of the four quantities of `kinsim.diagnostics.causes`, those that the page shows."""

TOLD = {
    "sampling": "M put on the nodes",
    "transport": "transport between cells",
    "boundary": "through the two ends",
    "force": "gravity and friction",
    "window": "lost at the edge in ξ",
    "projection": "projection to M",
}


@dataclass(frozen=True, eq=False)
class Books:
    """Each of the three over the domain.

    Attributes:
        start, now: Shape (3,).
        causes: What each stage did so far, by its words; nothing for order 2 and on smooth chutes, where
            they are not told apart.
    """

    start: Array
    now: Array
    causes: dict[str, Array]

    @property
    def unexplained(self) -> Array:
        """What is now, less the start and all causes: rounding."""
        booked: Array = np.sum(list(self.causes.values()), axis=0)
        return self.now - self.start - booked


class Ledger:
    """Books of a play; remembers the start."""

    def __init__(self, play: Play) -> None:
        self._play = play
        self.start = self._of(*play.scene.initial())

    def books(self) -> Books:
        """After the last whole step."""
        loop = self._play.simulation
        causes: dict[str, Array] = {}
        if loop.causes is not None:
            summed = loop.causes.kept()["sum"]
            causes = {TOLD[name]: row[[0, 1, 3]] for name, row in zip(STAGES, summed, strict=True)}
        return Books(self.start, self._of(loop.solver.h, loop.solver.q), causes)

    def _of(self, h: Array, q: Array) -> Array:
        """Integrals over x of h, q and q^2/(2h) + beta h^2/2."""
        scene = self._play.scene
        sums = np.array([h.sum(), q.sum(), of_state(h, q, scene.beta).sum()])
        return np.asarray(scene.cells.dx * sums)


def stage_of(cause: str) -> str | None:
    """The stage of `play` in which a cause acts."""
    places = {TOLD["transport"]: "transport", TOLD["boundary"]: "transport", TOLD["sampling"]: "transport",
              TOLD["force"]: "force", TOLD["window"]: "force", TOLD["projection"]: "projection"}  # fmt: skip
    return places.get(cause)
