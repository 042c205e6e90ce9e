"""Pilot runs: a scene on fewer cells tells how large velocity errors will be on all of them, and how many cells sleep.

Pilots run on two thirds and a third of the cells, but not on fewer than `LEAST`: a scene that has no more than twice as
many is its own pilot. Their steps are as long beside dx as those of the run, so that Courant numbers are the same. The
velocity error of a method hardly depends on dx: it says where, not how often, a flux is off. What it is in the finer
pilot is taken for the scene itself, times a margin that is measured, too: how much the velocity errors of this scene
change from the coarser pilots to the finer ones, as far as it is from the finer ones to the scene.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtrit

from ..balance.stages import Array
from ..clock import Courant, Fixed
from ..kinetic.velocity import Fitted, Uniform
from ..method import Kinetic
from ..run import ENDED
from ..scene import Scene
from ..stepper import largest_courant
from ..studies.study import study
from .family import NUMBER
from .judge import mass_of
from .pace import at_pace, finer, varied

LEAST = 80
"""On fewer cells a scene is another one."""

FINE = 2.0 / 3.0
"""Cells of the finer pilots over those of the scene, if these are many."""

CONFIDENCE = 0.95
"""So often the next change of a velocity error, normally distributed about none, is to stay within the margin."""

UNEVEN = 0.25
"""Steps of one length, in place of those of a `Courant` clock, are taken for so much of a level."""

TIMED_STEPS = 16
ROUNDS = 5
QUARTER = 0.25


def levels(count: int) -> tuple[float, float]:
    """Cells of the coarser and of the finer pilots, over the `count` cells of the scene."""
    fine = min(max(FINE, 2.0 * LEAST / count), 1.0)
    return 0.5 * fine, fine


class Pilots:
    """Velocity errors of methods that share a twin, measured on the coarser levels of a scene as they are asked for.

    Args:
        scene: Whose velocity errors.
        method: Whose twin.
        clock: When its runs end, and how long their steps are.
        options: Those of a study.
    """

    def __init__(self, scene: Scene, method: Kinetic, clock: Fixed | Courant, **options: Any) -> None:
        self._options = options
        coarse, fine = levels(scene.cells.count)
        self._ahead = max(math.log2(1.0 / fine), UNEVEN if isinstance(clock, Courant) else 0.0)
        self._scenes = [finer(scene, level) for level in (coarse, fine)]
        self._clocks = [at_pace(scene, method, clock, level) for level in (coarse, fine)]
        self._sleeps = isinstance(clock, Fixed)
        self.floor = float(np.finfo(float).eps) * max(one.steps for one in self._clocks) / fine
        self._found: dict[Kinetic, Array] = {}
        self._awake: dict[Kinetic, float] = {}
        self._scene, self._twin = scene, method.twin
        closed, awake = self._run([method.twin])
        self._closed, self._of_twin = closed[:, 0], float(awake[-1, 0])

    def ask(self, methods: Sequence[Kinetic]) -> None:
        """Run the pilots of `methods` that were not run before."""
        new = [method for method in dict.fromkeys(methods) if method not in self._found]
        if not new:
            return
        heights, awake = self._run(new)
        for at, method in enumerate(new):
            apart = [
                np.abs(h - closed).sum() * one.cells.dx / mass_of(one)
                for h, closed, one in zip(heights[:, at], self._closed, self._scenes, strict=True)
            ]
            self._found[method] = np.maximum(np.array(apart), self.floor)
            self._awake[method] = float(awake[-1, at])

    def _run(self, methods: Sequence[Any]) -> tuple[np.ndarray, Array]:
        """Heights at the end, an array of arrays over (level, method), and shares of cells awake; NaN if stopped."""
        pairs = [(level, method) for level in range(len(self._scenes)) for method in methods]
        over = {
            "method": [method for _, method in pairs],
            **varied([self._scenes[level] for level, _ in pairs]),
            "clock": [self._clocks[level] for level, _ in pairs],
        }
        found = study(self._scene, self._twin, self._clocks[0], over, paired=True, **self._options)
        heights = np.empty((len(self._scenes), len(methods)), dtype=object)
        good = np.isin(found["verdict_kind"].to_numpy(), ENDED)
        awake = np.where(good, found["awake"].to_numpy() if good.any() else np.nan, np.nan)
        for at, (level, _) in enumerate(pairs):
            count = self._scenes[level].cells.count
            h = found["h"].to_numpy()[at, :count] if good.any() and "h" in found else np.full(count, np.nan)
            heights[level, at % len(methods)] = h if good[at] else np.full(count, np.nan)
        return heights, awake.reshape(heights.shape)

    @property
    def margin(self) -> float:
        """The factor that covers 95 percent of what velocity errors do from the finer pilots to the scene."""
        errors = np.array(
            [found for found in self._found.values() if np.isfinite(found).all() and found.min() > self.floor]
        )
        if not errors.size:
            return 1.0
        change = np.log(errors[:, 1] / errors[:, 0])
        deviations = stdtrit(change.size, CONFIDENCE)  # Student's: few pilots tell a deviation with some doubt
        return float(np.exp(self._ahead * deviations * np.sqrt(np.mean(change**2))))

    def predicted(self, method: Kinetic) -> float:
        """The velocity error of a run on all cells, at most, with a confidence of 95 percent; inf if a pilot failed."""
        self.ask([method])
        measured = float(self._found[method][-1])
        return math.inf if math.isnan(measured) else measured if measured <= self.floor else measured * self.margin

    def awake(self, method: Kinetic) -> float:
        """The share of its cells that a run will step, as its finer pilot did; all with a `Courant` clock."""
        self.ask([method])
        share = self._awake[method]
        return share if self._sleeps and math.isfinite(share) else 1.0

    def keeps(self, method: Kinetic, accuracy: float) -> bool:
        """Whether a pilot was run, and says that the error will be below `accuracy`."""
        return method in self._found and self.predicted(method) <= accuracy

    @property
    def least_awake(self) -> float:
        """The least share of all pilots so far, and of their twin, which nodes do not keep awake."""
        known = [share for share in (*self._awake.values(), self._of_twin) if math.isfinite(share)]
        return min(known, default=1.0) if self._sleeps else 1.0

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


def nodes(method: Kinetic) -> int:
    """Velocity nodes of a method on a grid or with fitted ones."""
    assert isinstance(method.velocity, (Uniform, Fitted))
    return method.velocity.count


def kind_of(method: Kinetic) -> tuple[Any, ...]:
    """What methods share that differ in the number of nodes alone."""
    return type(method.velocity), method.equilibrium, method.force, method.projection


class Cost(NamedTuple):
    """Seconds that a step takes, without its cells and for all of them."""

    step: float
    cells: float

    def of(self, awake: float) -> float:
        """Seconds of a step in which this share of the cells is awake."""
        return self.step + awake * self.cells


def seconds_per_step(scene: Scene, methods: Sequence[Kinetic], **options: Any) -> list[Cost]:
    """What a step of each method costs.

    Of each kind the one with the fewest nodes, the one with the most and one in between are timed on all cells and on a
    quarter of them, in short runs that take turns; the others lie on the straight line in n through the least times.
    """
    kinds: dict[Any, list[Kinetic]] = {}
    for method in methods:
        kinds.setdefault(kind_of(method), []).append(method)
    telling = [method for of in kinds.values() for method in _telling(of)]
    few = finer(scene, QUARTER)
    number = NUMBER * largest_courant(methods[0])
    over = {
        "method": [*telling, *telling],
        **varied([scene] * len(telling) + [few] * len(telling)),
        "clock": [short_clock(scene, number)] * len(telling) + [short_clock(few, number)] * len(telling),
    }
    found = study(scene, methods[0], over["clock"][0], over, paired=True, repeats=ROUNDS, **options)
    whole, part = (found["wall_time"] / found["steps"]).min("repeat").to_numpy().reshape(2, -1)
    saved = 1.0 - few.cells.count / scene.cells.count
    cells = np.clip((whole - part) / saved, 0.0, whole) if saved > 0.0 else np.zeros_like(whole)
    timed = dict(zip(telling, np.stack([whole - cells, cells], axis=1), strict=True))
    out: dict[Kinetic, Cost] = {}
    for of in kinds.values():
        n, known = np.array([nodes(one) for one in _telling(of)]), np.array([timed[one] for one in _telling(of)])
        for one in of:
            out[one] = Cost(*(_line(n, column, nodes(one)) for column in known.T))
    return [out[one] for one in methods]


def _line(n: Array, seconds: Array, at: int) -> float:
    """The straight line through what was measured, which does not fall, at `at` nodes."""
    good = np.isfinite(seconds)
    if good.sum() < 2:
        return float(seconds[good].sum()) or math.nan
    slope, start = np.polyfit(n[good], seconds[good], 1)
    return max(float(start + max(slope, 0.0) * at), 0.0)


def _telling(of: Sequence[Kinetic]) -> list[Kinetic]:
    ordered = sorted(of, key=nodes)
    return list(dict.fromkeys([ordered[0], ordered[len(of) // 2], ordered[-1]]))


def short_clock(scene: Scene, number: float) -> Courant:
    """About `TIMED_STEPS` steps, in which no cell sleeps."""
    mass_of(scene)
    return Courant(number, TIMED_STEPS * number * scene.cells.dx / scene.fastest)
