"""What looks at a run between its blocks of steps."""

from __future__ import annotations

import inspect
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ..checkpoint import Kept
from ..errors import InputError

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
    """Somebody's own object with a method `look`, or a function of a block; what else it lacks has the defaults.

    Attributes:
        failure: What it raised, in words, or nothing; from then on it is asked no more.
    """

    def __init__(self, own: Any, name: str) -> None:
        self.own, self.name, self.failure = own, name, ""
        self.every = getattr(own, "every", None)
        if self.every is not None and not (isinstance(self.every, int) and self.every >= 1):
            raise InputError(f"observer {name!r}: every = {self.every!r}; give a whole number from 1 on, or None")
        if inspect.isclass(own) or not callable(getattr(own, "look", own)):
            raise InputError(f"observer {name!r}: give an object with a method look(block), or a function of a block")

    def start(self, solver: Solver) -> None:
        self._asked("start", None, solver)

    def next_step(self, step: int) -> float:
        return float(self._asked("next_step", super().next_step(step), step))

    def next_time(self, t: float) -> float:
        return float(self._asked("next_time", math.inf, t))

    def next_past(self, t: float) -> float:
        return float(self._asked("next_past", math.inf, t))

    def look(self, block: Block) -> str | None:
        if self.every and block.step % self.every:
            return None  # the block ended here for somebody else
        said = self._asked("look", None, block)
        return said if isinstance(said, str) and said else None

    def result(self) -> Any:
        return self._asked("result", None)

    def kept(self) -> Kept:
        return dict(self._asked("kept", {}))

    def restore(self, kept: Kept) -> None:
        self._asked("restore", None, kept)

    def _asked(self, method: str, default: Any, *given: Any) -> Any:
        """The answer of the object to a method; the default where it has none, or raises something."""
        answer = getattr(self.own, method, self.own if method == "look" else None)
        if answer is None or (self.failure and method not in ("result", "kept")):
            return default
        try:
            return answer(*given)
        except Exception as error:
            self.failure = self.failure or f"observer {self.name!r} failed: {type(error).__name__}: {error}"
            return default


def adopt(observers: Sequence[Any]) -> list[Adopted]:
    """Observers, each with a name of its own, of whatever was given."""
    made: list[Adopted] = []
    for own in observers:
        name = str(getattr(own, "name", "") or getattr(own, "__name__", "") or type(own).__name__)
        taken = sum(other.name.partition(" #")[0] == name for other in made)
        made.append(Adopted(own, f"{name} #{taken + 1}" if taken else name))
    return made
