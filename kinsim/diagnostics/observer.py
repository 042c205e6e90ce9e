"""What looks at a run between its blocks of steps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ..checkpoint import Kept

if TYPE_CHECKING:
    from ..solver.solver import Block, Solver


class Observer:
    """An observer of a run; subclasses write what they need, and `look` at least.

    Attributes:
        name: Under which `Run.observed` has its result.
        every: Look after every so many steps; None looks whenever a block of steps ends, about every 0.1 s.
    """

    name = ""
    every: int | None = None

    def start(self, solver: Solver) -> None:
        """The run begins at the state (solver.h, solver.q)."""

    def next_step(self, step: int) -> float:
        """After which step to look next."""
        return step + self.every - step % self.every if self.every else math.inf

    def next_time(self, t: float) -> float:
        """At which time to look next: a step ends there exactly."""
        return math.inf

    def next_past(self, t: float) -> float:
        """After which time to look next: when the first step is past it."""
        return math.inf

    def look(self, block: Block) -> str | None:
        """A block of steps has ended at the state (block.h, block.q); what this returns ends the run, in its words."""
        raise NotImplementedError

    def result(self) -> Any:
        """What was noted."""
        return None

    def kept(self) -> Kept:
        """What was noted so far, as arrays for a checkpoint."""
        return {}

    def restore(self, kept: Kept) -> None:
        """Go on from there."""


class Adopted(Observer):
    """Somebody's own object with a method `look`, or a function of a block; what else it lacks has the defaults."""

    def __init__(self, own: Any) -> None:
        self.own = own
        self.name = str(getattr(own, "name", getattr(own, "__name__", type(own).__name__)))
        self.every = getattr(own, "every", None)
        looks = getattr(own, "look", own)
        for method in ("start", "next_step", "next_time", "next_past", "result", "kept", "restore"):
            if hasattr(own, method):
                setattr(self, method, getattr(own, method))
        self.look = looks  # type: ignore[method-assign]


def adopt(observer: Any) -> Observer:
    """An observer, of whatever was given."""
    return observer if isinstance(observer, Observer) else Adopted(observer)
