"""Steps of one length for all methods that are to meet: a scene's Courant clock made steady."""

from __future__ import annotations

import math
from dataclasses import replace

from ..clock import Courant, Fixed
from ..errors import InputError
from ..method import Kinetic, Macroscopic
from ..scene import Scene
from ..simulate import simulate
from ..stepper import largest_courant
from ..studies.member import ONCE


def end_of(clock: Fixed | Courant) -> float:
    """The time at which a clock ends."""
    return clock.end if isinstance(clock, Courant) else clock.steps * clock.dt


def twin_of(method: Kinetic | Macroscopic) -> Macroscopic:
    """The closed form of a method."""
    return method.twin if isinstance(method, Kinetic) else method


def finer(scene: Scene, factor: float) -> Scene:
    """The scene on `factor` times as many cells, at least 2."""
    count = max(2, round(scene.cells.count * factor))
    return scene if count == scene.cells.count else replace(scene, cells=replace(scene.cells, count=count))


def steady(scene: Scene, method: Kinetic | Macroscopic, number: float, end: float) -> Fixed:
    """Steps of one length up to `end`: the shortest that the closed form asks for at the Courant number `number`.

    Raises:
        InputError: The closed form does not come to the end.
    """
    allowed = min(number, largest_courant(method))
    run = simulate(scene, twin_of(method), Courant(allowed, end), ONCE)
    if run.verdict.kind == "interrupted":
        raise KeyboardInterrupt
    if run.t[-1] < end:
        raise InputError(f"the closed form does not come to t = {end:g}: {run.verdict}; take a scene that does")
    shortest = float(run.dt[:-1].min()) if run.dt.size > 1 else end
    steps = math.ceil(end / shortest * allowed / number)
    return Fixed(end / steps, steps)
