"""Pilot runs: a scene on a half and a quarter of its cells tells how large velocity errors will be on all of them.

The velocity error of a method hardly depends on dx and dt: they set where, not how often, a flux is off. What it is
on half the cells is taken for the scene itself, times a margin that is measured, too: how much velocity errors of
this scene change from a quarter of its cells to a half.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..balance.stages import Array
from ..clock import Courant
from ..kinetic.velocity import Fitted, Uniform
from ..method import Kinetic
from ..run import ENDED
from ..scene import Scene
from ..stepper import largest_courant
from ..studies.study import study
from .family import NUMBER
from .judge import mass_of
from .pace import finer, steady

LEVELS = (0.25, 0.5)

CONFIDENCE = 1.645
"""So many standard deviations cover 95 percent of a normal distribution on one side."""

TIMED_STEPS = 16
ROUNDS = 5


class Pilots:
    """Velocity errors of methods that share a twin, measured on the coarser levels of a scene as they are asked for.

    Args:
        scene: Whose velocity errors.
        method: Whose twin.
        end: When its runs end.
        options: Those of a study.
    """

    def __init__(self, scene: Scene, method: Kinetic, end: float, **options: Any) -> None:
        self._options = options
        self._scenes = [finer(scene, level) for level in LEVELS]
        number = NUMBER * largest_courant(method)
        self._clocks = [steady(one, method, number, end) for one in self._scenes]
        self.floor = float(np.finfo(float).eps) * max(clock.steps for clock in self._clocks) / LEVELS[-1]
        self._found: dict[Kinetic, Array] = {}
        self._scene, self._twin = scene, method.twin
        self._closed = self._heights([method.twin])[:, 0]

    def ask(self, methods: Sequence[Kinetic]) -> None:
        """Run the pilots of `methods` that were not run before."""
        new = [method for method in dict.fromkeys(methods) if method not in self._found]
        if not new:
            return
        heights = self._heights(new)
        for at, method in enumerate(new):
            apart = [
                np.abs(h - closed).sum() * one.cells.dx / mass_of(one)
                for h, closed, one in zip(heights[:, at], self._closed, self._scenes, strict=True)
            ]
            self._found[method] = np.maximum(np.array(apart), self.floor)

    def _heights(self, methods: Sequence[Any]) -> np.ndarray:
        """Heights at the end, an array of arrays over (level, method); NaN where a pilot was stopped."""
        levels = range(len(LEVELS))
        pairs = [(level, method) for level in levels for method in methods]
        over = {
            "method": [method for _, method in pairs],
            "cells.count": [self._scenes[level].cells.count for level, _ in pairs],
            "clock": [self._clocks[level] for level, _ in pairs],
        }
        found = study(self._scene, self._twin, self._clocks[0], over, paired=True, **self._options)
        out = np.empty((len(LEVELS), len(methods)), dtype=object)
        good = np.isin(found["verdict_kind"].to_numpy(), ENDED)
        for at, (level, _) in enumerate(pairs):
            count = self._scenes[level].cells.count
            h = found["h"].to_numpy()[at, :count] if good.any() and "h" in found else np.full(count, np.nan)
            out[level, at % len(methods)] = h if good[at] else np.full(count, np.nan)
        return out

    @property
    def margin(self) -> float:
        """The factor that covers 95 percent of what velocity errors do from one level to the next."""
        errors = np.array(
            [found for found in self._found.values() if np.isfinite(found).all() and found.min() > self.floor]
        )
        if not errors.size:
            return 1.0
        return float(np.exp(CONFIDENCE * np.sqrt(np.mean(np.log(errors[:, 1] / errors[:, 0]) ** 2))))

    def predicted(self, method: Kinetic) -> float:
        """The velocity error of a run on all cells, at most, with a confidence of 95 percent; inf if a pilot failed."""
        self.ask([method])
        measured = float(self._found[method][-1])
        return math.inf if math.isnan(measured) else measured if measured <= self.floor else measured * self.margin

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
        return float(np.exp(start + slope * scale(nodes(method))) / self.margin)


def nodes(method: Kinetic) -> int:
    """Velocity nodes of a method on a grid or with fitted ones."""
    assert isinstance(method.velocity, (Uniform, Fitted))
    return method.velocity.count


def kind_of(method: Kinetic) -> tuple[Any, ...]:
    """What methods share that differ in the number of nodes alone."""
    return type(method.velocity), method.equilibrium, method.force, method.projection


def seconds_per_step(scene: Scene, methods: Sequence[Kinetic], **options: Any) -> Array:
    """What a step of each method costs on all cells, none asleep, shape (methods,).

    Of each kind the one with the fewest nodes, the one with the most and one in between are timed, in short runs that
    take turns; the others lie on the straight line in n through the least times.
    """
    kinds: dict[Any, list[Kinetic]] = {}
    for method in methods:
        kinds.setdefault(kind_of(method), []).append(method)
    timed = {method: 0.0 for of in kinds.values() for method in _telling(of)}
    clock = short_clock(scene, NUMBER * largest_courant(methods[0]))
    found = study(scene, methods[0], clock, {"method": list(timed)}, repeats=ROUNDS, **options)
    each = (found["wall_time"] / found["steps"]).min("repeat").to_numpy()
    timed.update(zip(timed, each.tolist(), strict=True))
    out = np.empty(len(methods))
    for of in kinds.values():
        known = np.array([(nodes(one), timed[one]) for one in of if np.isfinite(timed.get(one, np.nan))]).reshape(-1, 2)
        slope, start = np.polyfit(known[:, 0], known[:, 1], 1) if len(known) > 1 else (0.0, known[:, 1].sum() or np.nan)
        for one in of:
            out[methods.index(one)] = start + max(slope, 0.0) * nodes(one)
    return out


def _telling(of: Sequence[Kinetic]) -> list[Kinetic]:
    ordered = sorted(of, key=nodes)
    return list(dict.fromkeys([ordered[0], ordered[len(of) // 2], ordered[-1]]))


def short_clock(scene: Scene, number: float) -> Courant:
    """About `TIMED_STEPS` steps, in which no cell sleeps."""
    mass_of(scene)
    return Courant(number, TIMED_STEPS * number * scene.cells.dx / scene.fastest)
