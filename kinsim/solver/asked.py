"""What a clock asks of a march."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..clock import AnyClock
from ..scene import Scene
from .march import ROUNDING, Asked

if TYPE_CHECKING:
    from .solver import Solver

SHORTEST = 1e-9
"""Steps shorter than this share of the whole time are not worth taking."""

LARGEST = float(np.finfo(float).max)


def asked_of(solver: Solver, clock: AnyClock, until: float = math.inf, past: float = math.inf) -> Asked:
    """Steps as the clock wants them, to land on the time `until`, and no further than the first one at `past`."""
    scene, grid = solver.scene, solver.grid
    number, velocity = clock.number, solver.method.velocity_cells
    bound, tight, stops, slow = math.inf, math.inf, 1.0, 0.0
    if grid is not None and velocity is not None:
        bound, slow = grid.bound, 1e-3 * grid.dxi
        if not velocity.follows:
            stops, tight = float(velocity.beyond == "stop"), bound - 2.0 * grid.dxi
    lifts = 0.0
    if scene.ground.bends:
        lifts = 2.0 if scene.chute.lifting == "stop" else 1.0  # type: ignore[union-attr]
    return Asked(
        dt=clock.dt, number=number,
        falling=falling(scene, number) if number else 0.0, shortest=SHORTEST * clock.end if number else 0.0,
        limit=math.inf if solver.force else solver.limit * (1.0 + ROUNDING), room=largest_sum(solver), bound=bound,
        stops=stops, pull=strongest(scene), tight=tight, still=0.0 if grid is not None else 1e-12, still_per_h=slow,
        stop_at_rest=float(clock.stop_at_rest), until=until, past=past, lifts=lifts,
    )  # fmt: skip


def largest_sum(solver: Solver) -> float:
    """How large sums may become beside the mass in the beginning, to which they are compared."""
    return LARGEST * min(solver.first_mass or 1.0, 1.0) / (8.0 * max(solver.scene.cells.dx, 1.0))


def strongest(scene: Scene) -> float:
    """The largest acceleration |sin zeta| + R."""
    return float(np.max(np.abs(scene.pull) + scene.resistance))


def falling(scene: Scene, number: float) -> float:
    """The speed that keeps a grain which starts to slide from passing more than `number` cells in a step."""
    drive = max(float(np.max(np.abs(scene.pull) - scene.resistance)), 0.0)
    return math.sqrt(0.5 * number * scene.cells.dx * drive)
