"""What a step of a method costs on a scene, timed in short runs that take turns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..clock import Courant
from ..method import Kinetic
from ..scene import Scene
from ..studies.study import study
from .family import NUMBER
from .pace import finer, under_way, varied
from .pilot import by_kind, nodes

TIMED_STEPS = 16
ROUNDS = 5
QUARTER = 0.25


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
    scene, kinds = under_way(scene), by_kind(methods)
    telling = [method for of in kinds for method in _telling(of)]
    few = finer(scene, QUARTER)
    over = {
        "method": [*telling, *telling],
        **varied([scene] * len(telling) + [few] * len(telling)),
        "clock": [short_clock(scene, NUMBER)] * len(telling) + [short_clock(few, NUMBER)] * len(telling),
    }
    found = study(scene, methods[0], over["clock"][0], over, paired=True, repeats=ROUNDS, **options)
    whole, part = (found["wall_time"] / found["steps"]).min("repeat").to_numpy().reshape(2, -1)
    saved = 1.0 - few.cells.count / scene.cells.count
    cells = np.clip((whole - part) / saved, 0.0, whole) if saved > 0.0 else np.zeros_like(whole)
    timed = dict(zip(telling, np.stack([whole - cells, cells], axis=1), strict=True))
    out: dict[Kinetic, Cost] = {}
    for of in kinds:
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
    return list(dict.fromkeys([of[0], of[len(of) // 2], of[-1]]))


def short_clock(scene: Scene, number: float) -> Courant:
    """About `TIMED_STEPS` steps, in which no cell rests."""
    return Courant(number, TIMED_STEPS * number * scene.cells.dx / scene.fastest)
