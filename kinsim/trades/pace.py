"""Steps of one length for all methods that are to meet: a scene's Courant clock made steady."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..clock import Courant, Fixed
from ..errors import InputError
from ..interrupt import unless_interrupted
from ..mean import mean_velocity
from ..method import Kinetic, Macroscopic
from ..model.cells import Cells
from ..model.heap import Profile
from ..scene import Scene
from ..simulate import simulate
from ..studies.member import ONCE


def twin_of(method: Kinetic | Macroscopic) -> Macroscopic:
    """The closed form of a method."""
    return method.twin if isinstance(method, Kinetic) else method


def finer(scene: Scene, factor: float) -> Scene:
    """The scene on `factor` times as many cells, at least 2.

    A heap that is given cell by cell is averaged, and so is one that falls between the middles of fewer cells.
    """
    count = max(2, round(scene.cells.count * factor))
    if count == scene.cells.count:
        return scene
    cells = replace(scene.cells, count=count)
    if not isinstance(scene.heap, Profile):
        sampled = replace(scene, cells=cells)
        if sampled.initial()[0].any() or not scene.initial()[0].any():
            return sampled
    return replace(scene, cells=cells, heap=_averaged(scene, cells))


def varied(scenes: Sequence[Scene]) -> dict[str, list[Any]]:
    """What scenes that `finer` made differ in, as the lists of a paired study."""
    over: dict[str, list[Any]] = {"cells.count": [one.cells.count for one in scenes]}
    if any(isinstance(one.heap, Profile) for one in scenes):
        over["heap"] = [one.heap for one in scenes]
    return over


def at_pace(clock: Fixed | Courant, level: float) -> Fixed | Courant:
    """The clock of a scene on `level` times its cells, with steps as long beside dx."""
    if isinstance(clock, Courant):
        return clock
    steps = max(1, round(clock.steps * level))
    return Fixed(clock.end / steps, steps)


def _averaged(scene: Scene, cells: Cells) -> Profile:
    """Mass and momentum of the scene's own cells, as averages over others."""
    edges, wanted = (np.linspace(one.left, one.right, one.count + 1) for one in (scene.cells, cells))
    h, q = (
        np.maximum(np.diff(np.interp(wanted, edges, np.concatenate([[0.0], np.cumsum(part)]))), least)
        * (scene.cells.dx / cells.dx)
        for part, least in zip(scene.initial(), (0.0, -np.inf), strict=True)
    )
    return Profile(h, mean_velocity(q, h))


def steady(scene: Scene, method: Kinetic | Macroscopic, number: float, end: float) -> Fixed:
    """Steps of one length up to `end`: the shortest that the closed form asks for at the Courant number `number`.

    Raises:
        InputError: The closed form does not come to the end.
    """
    allowed = min(number, 1.0)
    run = unless_interrupted(simulate(scene, twin_of(method), Courant(allowed, end), ONCE))
    if run.t[-1] < end:
        raise InputError(f"the closed form does not come to t = {end:g}: {run.verdict}; take a scene that does")
    shortest = float(run.dt[:-1].min()) if run.dt.size > 1 else end
    steps = math.ceil(end / shortest * allowed / number)
    return Fixed(end / steps, steps)


def under_way(scene: Scene) -> Scene:
    """The scene itself, if it has mass; else as the closed form leaves it when its streams have crossed all cells.

    A step costs little where all is dry.
    """
    if scene.initial()[0].any():
        return scene
    method = Macroscopic(4)
    across = (scene.cells.right - scene.cells.left) / scene.fastest
    run = unless_interrupted(simulate(scene, method, Courant(0.8, across), ONCE))
    return replace(scene, heap=Profile(run.h[-1], run.u[-1]))
