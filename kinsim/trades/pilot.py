"""Pilot runs: a scene on fewer cells tells how large velocity errors will be on all of them, and how many cells rest.

Pilots run on two thirds and a third of the cells; a scene of fewer than `OWN` cells is its own pilot, whose errors are
measured, not foreseen, and so is one whose pilots stop, or tell less than is `PROMISED`. Steps are as long beside dx as
those of the run, and those of a `Courant` clock are its own: each pilot is held against its twin in the same steps. The
velocity error of a method hardly depends on dx: it says where, not how often, a flux is off. What it is in the finer
pilot is taken for the scene itself, times a margin that is measured, too: how much the velocity errors of this scene
change from the coarser pilots to the finer ones, as far as it is from the finer ones to the scene. Some methods with
few nodes tell the margin, always the same of a family, so that a prediction does not depend on what else was asked.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from scipy.special import stdtrit

from ..arrays import Array
from ..clock import Courant, Fixed
from ..kinetic.velocity import Fitted, Uniform
from ..method import Kinetic
from ..run import ENDED
from ..scene import Scene
from ..studies.member import Member, Request
from ..studies.record import Record
from ..studies.study import collect
from .judge import mass_of
from .pace import at_pace, finer

OWN = 240
"""With fewer cells a scene is its own pilot: on a third of them it would be another scene."""

FINE = 2.0 / 3.0
"""Cells of the finer pilots over those of the scene, if these are many."""

PROMISED = 10.0
"""A prediction is to be no farther off than this: above by the margin, times a change as large the other way."""

TELLING = 3
"""So many methods of a kind tell the margin, those with the fewest nodes."""

CONFIDENCE = 0.975
"""So often the next change of a velocity error, normally distributed about none, is to stay within the margin."""

DTS = Request(fields=("dt",))
SAME_STEPS = Request(force=True)
"""Of the twin: a thin front of its own may be faster than those of the pilot whose steps it takes."""


def levels(count: int) -> tuple[float, ...]:
    """Cells of the coarser and of the finer pilots, over the `count` cells of the scene; 1 where it is its own."""
    return (0.5 * FINE, FINE) if count >= OWN else (1.0,)


@dataclass(frozen=True)
class _Level:
    """The scene on some of its cells, and when."""

    scene: Scene
    clock: Fixed | Courant
    mass: float

    @classmethod
    def of(cls, scene: Scene, clock: Fixed | Courant, share: float) -> Self:
        """Steps are as long beside dx as those of `clock`."""
        coarse = finer(scene, share)
        return cls(coarse, at_pace(clock, coarse.cells.count / scene.cells.count), mass_of(coarse, clock.end))

    def apart(self, run: Record, twin: Record) -> float:
        """L1(h) between the ends of two runs, over the mass; NaN if one was stopped."""
        if any(one.figures["verdict_kind"] not in ENDED for one in (run, twin)):
            return math.nan
        return float(np.abs(run.arrays["h"] - twin.arrays["h"]).sum() * self.scene.cells.dx / self.mass)


class Pilots:
    """Velocity errors of methods that share a twin, measured on the coarser levels of a scene as they are asked for.

    Args:
        scene: Whose velocity errors.
        family: Methods with one twin; those with few nodes tell the margin.
        clock: When its runs end, and how long their steps are.
        options: `keep`, `resume`, `tell`, ... of a study.
    """

    def __init__(self, scene: Scene, family: Sequence[Kinetic], clock: Fixed | Courant, **options: Any) -> None:
        self._options = options
        shares = levels(scene.cells.count)
        self._ahead = math.log2(1.0 / shares[-1])
        self._whole, self._levels = _Level.of(scene, clock, 1.0), [_Level.of(scene, clock, one) for one in shares]
        self._known: dict[str, Record] = {}
        self._same_dt = isinstance(clock, Fixed)
        self._found: dict[Kinetic, Array] = {}
        self._awake: dict[Kinetic, float] = {}
        self._twin = family[0].twin
        closed = self._run([Member(level.scene, self._twin, level.clock, SAME_STEPS) for level in self._levels])
        self._of_twin = _awake(closed[-1])
        steps = max(record.figures.get("steps", 0) for record in closed)
        self.floor = float(np.finfo(float).eps) * steps / shares[-1]
        self.margin = self._margin(family)

    def ask(self, methods: Sequence[Kinetic]) -> None:
        """Run the pilots of `methods` that were not run before."""
        new = [method for method in dict.fromkeys(methods) if method not in self._found]
        errors, awake = self._errors(self._levels, new)
        for at, method in enumerate(new):
            self._found[method], self._awake[method] = errors[:, at], awake[at]

    def _errors(self, of: Sequence[_Level], methods: Sequence[Kinetic]) -> tuple[Array, list[float]]:
        """Velocity errors over (level, method), each to the twin in the same steps, and shares awake on the last."""
        asked = [(level, method) for level in of for method in methods]
        runs = self._run([Member(level.scene, method, level.clock, DTS) for level, method in asked])
        same = [level.clock if self._same_dt else run.replay or level.clock
                for (level, _), run in zip(asked, runs, strict=True)]  # fmt: skip
        twins = self._run([Member(level.scene, self._twin, clock, SAME_STEPS)
                           for (level, _), clock in zip(asked, same, strict=True)])  # fmt: skip
        apart = [level.apart(run, twin) for (level, _), run, twin in zip(asked, runs, twins, strict=True)]
        found = np.maximum(np.reshape(apart, (len(of), len(methods))), self.floor)
        return found, [_awake(run) for run in runs[len(runs) - len(methods) :]]

    def _run(self, members: Sequence[Member]) -> list[Record]:
        """The record of each."""
        new = [one for one in members if one.key not in self._known]
        self._known |= dict(zip((one.key for one in new), collect(new, **self._options), strict=True))
        return [self._known[one.key] for one in members]

    def _margin(self, family: Sequence[Kinetic]) -> float:
        """The factor that covers 97.5 percent of what velocity errors do from the finer pilots to the scene."""
        if not self._ahead:
            return 1.0
        kinds = by_kind(family)
        self.ask([method for of in kinds for method in of[:TELLING]])
        changes = np.concatenate([self._changes(of) for of in kinds])
        if not changes.size:
            return 1.0
        deviations = stdtrit(changes.size, CONFIDENCE)  # Student's: few pilots tell a deviation with some doubt
        return float(np.exp(self._ahead * deviations * np.sqrt(np.mean(changes**2))))

    def _changes(self, ordered: Sequence[Kinetic]) -> Array:
        """What the first of them do, in logarithms, whose pilots come to the end and show more than rounding."""
        found: list[float] = []
        for method in ordered:
            self.ask([method])
            coarse, fine = self._found[method]
            if coarse > self.floor and fine > self.floor:
                found.append(math.log(fine / coarse))
            if len(found) == TELLING:
                break
        return np.array(found)

    def foretells(self, method: Kinetic) -> bool:
        """Whether its error is foreseen, with the margin; else it is measured on all cells."""
        self.ask([method])
        return self._ahead > 0.0 and self.margin**2 <= PROMISED and bool(np.isfinite(self._found[method]).all())

    def predicted(self, method: Kinetic) -> float:
        """The velocity error of a run on all cells, at most, with a confidence of 97.5 percent; inf if that stops.

        Where the pilots tell less than is promised, or one of them stopped, it is measured on all cells.
        """
        if not self.foretells(method):
            found = self._errors([self._whole], [method])[0].item()
            return math.inf if math.isnan(found) else float(found)
        found = float(self._found[method][-1])
        return found * self.margin if found > self.floor else found

    def awake(self, method: Kinetic) -> float:
        """The share of its cells that a run will step, as its finer pilot did."""
        self.ask([method])
        share = self._awake[method]
        return share if math.isfinite(share) else 1.0

    def keeps(self, method: Kinetic, accuracy: float) -> bool:
        """Whether a pilot was run, and says that the error will be below `accuracy`."""
        return method in self._found and self.predicted(method) <= accuracy

    @property
    def least_awake(self) -> float:
        """The least share of all pilots so far, and of their twin, which nodes do not keep awake."""
        known = [share for share in (*self._awake.values(), self._of_twin) if math.isfinite(share)]
        return min(known, default=1.0)

    def foreseen(self, method: Kinetic) -> float:
        """About what `predicted` will be, from the order of pilots of the same kind; 0 where there are too few."""
        of = [
            (nodes(one), found[-1])
            for one, found in self._found.items()
            if kind_of(one) == kind_of(method) and found[-1] > self.floor
        ]
        if len(of) < 3:
            return 0.0
        n, error = np.array(of).T
        scale = np.log if isinstance(method.velocity, Uniform) else np.asarray
        slope, start = np.polyfit(scale(n), np.log(error), 1)
        return float(np.exp(start + slope * scale(nodes(method))) / max(self.margin, 2.0))


def _awake(record: Record) -> float:
    return float(record.figures["awake"]) if record.figures["verdict_kind"] in ENDED else math.nan


def untold(method: Kinetic) -> str:
    """Why no pilot run tells the velocity error of a method, or nothing."""
    if method.scheme == 4:
        return ""
    unstable = f"scheme {method.scheme} amplifies any rounding where a mass stops"
    return f"{unstable}, so that no pilot run tells its velocity error"


def nodes(method: Kinetic) -> int:
    """Velocity nodes of a method on a grid or with fitted ones."""
    assert isinstance(method.velocity, (Uniform, Fitted))
    return method.velocity.count


def kind_of(method: Kinetic) -> tuple[Any, ...]:
    """What methods share that differ in the number of nodes alone."""
    return type(method.velocity), method.equilibrium, method.force, method.projection


def by_kind(methods: Iterable[Kinetic]) -> list[list[Kinetic]]:
    """Methods of each kind, those with the fewest nodes first."""
    kinds: dict[Any, list[Kinetic]] = {}
    for method in sorted(methods, key=nodes):
        kinds.setdefault(kind_of(method), []).append(method)
    return list(kinds.values())
