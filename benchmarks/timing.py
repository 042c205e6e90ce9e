"""Interleaved timing: every contender takes its turn in each round, so that what disturbs one disturbs all.

The clock is that of the thread: it stands still while others have the core. All contenders compute on one thread.
"""

from __future__ import annotations

import math
import statistics
import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from cases import Array, Call


@dataclass(frozen=True)
class Times:
    """Seconds of the thread per call, or per step of a call that takes several; sorted."""

    all: tuple[float, ...]

    @property
    def median(self) -> float:
        """The one in the middle."""
        return statistics.median(self.all)

    def words(self, per: float = 1.0, unit: str = "s") -> str:
        """Least, median and greatest, divided by `per`."""
        return " / ".join(f"{one / per:.3g}" for one in (self.all[0], self.median, self.all[-1])) + f" {unit}"


def interleave(calls: Mapping[str, Call], rounds: int = 9, least: float = 1e-2) -> dict[str, Times]:
    """Time all calls in turn, `rounds` times; short ones are repeated within a turn until it takes `least` seconds.

    A turn is long beside its first call, which finds the caches full of what others left there: a run does not.
    """
    repeats = {}
    for name, call in calls.items():
        call()
        once = _once(call, 1) * getattr(call, "steps", 1)
        repeats[name] = max(1, math.ceil(least / max(once, 1e-9)))
    found: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            found[name].append(_once(call, repeats[name]))
    return {name: Times(tuple(sorted(times))) for name, times in found.items()}


def _once(call: Call, repeats: int) -> float:
    began = time.thread_time()
    for _ in range(repeats):
        call()
    return (time.thread_time() - began) / (repeats * getattr(call, "steps", 1))


def same(what: str, ours: list[Array], theirs: list[Array], within: float = 1e-12) -> None:
    """Complains where entries of h, q or f differ by more than `within` of the largest one of theirs."""
    for name, a, b in zip("hqf"[: len(theirs)], ours, theirs, strict=True):
        if a.shape != b.shape:
            raise AssertionError(f"{what}: {name} is of shape {a.shape} here and {b.shape} there")
        apart, largest = float(np.max(np.abs(a - b))), float(np.max(np.abs(b)))
        if not apart <= within * largest:
            differ = f"{name} differs by {apart:.1e} where it goes up to {largest:.1e}"
            raise AssertionError(f"{what}: {differ}; timing them would mean nothing")


def exponent(sizes: list[int], seconds: list[float]) -> float:
    """The slope of the cost in a doubly logarithmic plot."""
    return float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])
