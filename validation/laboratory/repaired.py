"""Schemes 1 to 4 side by side, and the ground they are tried on."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from kinsim import Cells, ConstantSlope, Coulomb, Fixed, Frictionless, Kinetic, Macroscopic, Profile, Scene
from kinsim.exact import random_pile
from kinsim.solver.solver import Solver

Array = NDArray[np.float64]
DELTA = 0.3

SCHEMES = {
    "1": Macroscopic(1),
    "2": Macroscopic(2),
    "3": Macroscopic(3),
    "3, by face": Macroscopic(3, "face"),
    "4": Macroscopic(4),
    "4, second order": Macroscopic(4, order=2),
    "4, reflecting": Macroscopic(4, statics="reflect"),
}
"""In closed form."""

REPAIRED = [name for name in SCHEMES if name.startswith("4")]


def courant(method: Macroscopic | Kinetic, share: float = 0.9) -> float:
    """A Courant number: a share of the largest."""
    return share * Solver.limit


def scene_of(
    h: Array, u: Array | None = None, *, zeta: float = 0.0, delta: float = 0.0, ends: str = "wall", dx: float = 0.05
) -> Scene:
    """Cells that hold h and u; beta = 0.4 cos zeta."""
    friction = Coulomb(delta) if delta else Frictionless()
    return Scene(Cells(0.0, dx * h.size, h.size), Profile(h, u), ConstantSlope(zeta), friction, ends, 0.4)


def pile(zeta: float, seed: int, lowest: float, fill: float = 1.0, count: int = 40) -> Scene:
    """A random pile between walls that takes the share `fill` of what friction can hold at each face."""
    s, R, beta = math.sin(zeta), math.cos(zeta) * math.tan(DELTA), 0.4 * math.cos(zeta)
    cells = Cells(0.0, 0.05 * count, count)
    heap = random_pile(cells, pull=s, resistance=R, beta=beta, fill=fill, per="face", rng=seed, lowest=lowest)
    return Scene(cells, heap, ConstantSlope(zeta), Coulomb(DELTA), "wall", 0.4)


def shaken(scene: Scene, size: float, seed: int = 0) -> tuple[Array, Array]:
    """h and q of a scene at rest, disturbed by noise of `size` in h (relative) and u."""
    h, _ = scene.initial()
    dice = np.random.default_rng(seed)
    shifted = h * (1.0 + size * dice.standard_normal(h.size))
    return shifted, shifted * size * dice.standard_normal(h.size)


def steps(
    scene: Scene, method: Macroscopic | Kinetic, h: Array, q: Array, count: int, number: float
) -> Iterator[tuple[Array, Array, float]]:
    """Take `count` steps from (h, q) at a Courant number, until something is not finite: h, q after each, and dt."""
    solver = Solver(scene, method, force=True)
    solver.put(h, q)
    solver.warm_up()
    for _ in range(count):
        speed = max(solver.counted, solver.fastest)
        dt = min(number * scene.cells.dx / speed, scene.cells.dx) if speed > 0.0 else scene.cells.dx
        taken = solver.march(Fixed(dt, 10**9), 1).dts.size > 0
        yield (solver.h.copy(), solver.q.copy(), dt) if taken else (h + np.nan, q + np.nan, dt)
        if not taken:
            return
