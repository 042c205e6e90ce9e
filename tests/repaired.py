"""Every variant of scheme 4 in every wing, and what its tests start from."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from covering import covering

from kinsim import Cells, ConstantSlope, Coulomb, Fitted, Fixed, Kinetic, Macroscopic, Profile, Scene, Uniform
from kinsim.exact import random_pile

EPS = float(np.finfo(float).eps)
DELTA = 0.3

VARIANTS = {
    "first": {},
    "second": {"order": 2},
    "second, mc": {"order": 2, "limiter": "mc"},
    "reflecting": {"statics": "reflect"},
}
WINGS = {
    "closed": Macroscopic(4),
    "fitted": Kinetic(4, Fitted(6)),
    "grid": Kinetic(4, Uniform(32)),
    "matched": Kinetic(4, Uniform(32), "matched"),
}
METHODS = {
    f"{wing}, {name}": replace(method, **keys) for wing, method in WINGS.items() for name, keys in VARIANTS.items()
}
CLOSED = {name: method for name, method in METHODS.items() if name.startswith("closed")}

EVERY = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS.keys())
IN_CLOSED_FORM = pytest.mark.parametrize("method", CLOSED.values(), ids=CLOSED.keys())
LOWEST = (0.0, 0.3, 1.0)
"""Lowest heights of the piles, by seed; the first has a dry toe."""

PILES = [
    (zeta, boundary)
    for zeta in (0.0, DELTA / 2, DELTA, 2 * DELTA, 1.0, -2 * DELTA)
    for boundary in (("wall", "open") if abs(zeta) <= DELTA else ("wall",))
]
LEANING = [(*of, i % 3) for i, of in enumerate(PILES)]
LEANING_ANY = [(*of, seed) for of in PILES for seed in range(3)]
"""zeta, boundary and seed."""


def on_piles(piles: list[tuple[float, str, int]], *axes: Iterable[Any]) -> list[tuple[Any, ...]]:
    """Cases over axes and zeta, boundary and seed of some piles, in which all pairs meet."""
    return covering(*axes, *map(dict.fromkeys, zip(*piles, strict=True)), where=lambda *case: case[-3:] in piles)


def of_methods(cases: list[tuple[Any, ...]]) -> list[Any]:
    """Cases that begin with a wing and a variant, for tests that take the method which these two make."""
    return [
        pytest.param(METHODS[f"{wing}, {name}"], *rest, id="-".join(map(str, (f"{wing}, {name}", *rest))))
        for wing, name, *rest in cases
    ]


def pile(zeta: float, boundary: str, seed: int, fill: float = 1.0) -> Scene:
    """A random pile of 40 cells that takes the share `fill` of what friction can hold at each face."""
    s, R, beta = math.sin(zeta), math.cos(zeta) * math.tan(DELTA), 0.4 * math.cos(zeta)
    cells = Cells(0.0, 2.0, 40)
    heap = random_pile(
        cells, pull=s, resistance=R, beta=beta, fill=fill, per="face", rng=seed, lowest=LOWEST[seed % len(LOWEST)]
    )
    return Scene(cells, heap, ConstantSlope(zeta), Coulomb(DELTA), boundary, 0.4)


def leaning(zeta: float, lowest: float, share: float, seed: int) -> Scene:
    """A random pile of 50 cells on a steep chute, that takes 100 percent of the bound downhill at a share of faces."""
    s, R, beta = math.sin(zeta), math.cos(zeta) * math.tan(DELTA), 0.4 * math.cos(zeta)
    rng = np.random.default_rng(seed)
    theta = np.where(rng.random(49) < share, -np.sign(zeta), rng.uniform(-1, 1, 49))
    cells = Cells(0.0, 5.0, 50)
    h = np.concatenate([[0.0], np.cumsum((s + theta * R) * cells.dx / beta)])
    return Scene(cells, Profile(h - h.min() + lowest), ConstantSlope(zeta), Coulomb(DELTA), "wall", 0.4)


def steps(scene: Scene, method: Macroscopic | Kinetic, count: int, fastest: float = 0.5) -> Fixed:
    """Steps near the limit for masses up to `fastest`."""
    h, _ = scene.initial()
    speed = fastest + math.sqrt(2 * scene.beta * h.max()) * 1.05
    return Fixed(0.9 * scene.cells.dx / speed, count)


def wild(rng: np.random.Generator, count: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """Dry cells, 1e-300, 1e-12 and O(1) mixed, |u| up to twice c of the largest."""
    h = rng.choice([0.0, 1e-300, 1e-12, 1.0], count) * rng.uniform(0.1, 1.0, count)
    u = rng.uniform(-1, 1, count) * rng.choice([0.0, 0.1, 2.0], count)
    return h, np.where(h > 0, u, 0.0)
