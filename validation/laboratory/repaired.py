"""Schemes 1 to 4 side by side, and the ground they are tried on."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from kinsim import Cells, ConstantSlope, Coulomb, Courant, Frictionless, Kinetic, Macroscopic, Profile, Scene
from kinsim.exact import random_pile
from kinsim.stepper import Stepper, make_stepper

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
    """A Courant number: a share of the largest, which is 1, or 1/2 in second order."""
    return share * (0.5 if method.order == 2 else 1.0)


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
) -> Iterator[tuple[Stepper, float]]:
    """Take `count` steps from (h, q) at a Courant number, until something is not finite: the stepper after each, dt."""
    stepper = make_stepper(scene, method)
    for _ in range(count):
        dt = Courant(number, 1e9).next_dt(0, 0.0, stepper.begin(h, q), scene.cells.dx)
        assert dt is not None
        dt = min(dt, scene.cells.dx)  # where all is dry or as good as
        stepper.advance(dt)
        h, q = stepper.now.h1.copy(), stepper.now.q1.copy()
        yield stepper, dt
        if not (np.isfinite(h).all() and np.isfinite(q).all()):
            return
