"""Scenes and states that tests make up."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from kinsim import Cells, ConstantSlope, Coulomb, Frictionless, Profile, Scene
from kinsim.compiled import generic
from kinsim.kinetic.force import push

BETA = 0.4
"""beta of a scene on flat ground with epsilon = 0.4, k = 1."""


def random_states(rng: np.random.Generator, count: int, decades: float = 2.0) -> tuple[np.ndarray, np.ndarray]:
    """h from 10^-decades to 1, |u| up to 1.2 c (of `BETA`), every seventh cell at rest, every eleventh dry."""
    h = 10.0 ** rng.uniform(-decades, 0, count)
    u = rng.uniform(-1.2, 1.2, count) * np.sqrt(2 * BETA * h)
    u[::7] = 0.0
    h[::11] = 0.0
    u[::11] = 0.0
    return h, u


def scene_with(
    h: np.ndarray, u: np.ndarray | None = None, *, zeta: float = 0.0, delta: float | None = None,
    boundary: str | tuple[str, str] = "periodic", dx: float = 0.05,
) -> Scene:  # fmt: skip
    """A scene whose cells hold h and u; beta = 0.4 cos zeta."""
    return Scene(
        cells=Cells(0.0, dx * len(h), len(h)),
        heap=Profile(h=h, u=u),
        chute=ConstantSlope(zeta),
        friction=Frictionless() if delta is None else Coulomb(delta),
        boundary=boundary,
        epsilon=0.4,
    )


def ghosted(scene: Scene, array: np.ndarray, odd: bool = False) -> np.ndarray:
    """`array` with ghost cells as the boundary of the scene has them; `odd` quantities change sign at a wall."""
    kinds = scene.boundary if isinstance(scene.boundary, tuple) else (scene.boundary,) * 2
    values = []
    for kind, inner, across in ((kinds[0], array[0], array[-1]), (kinds[1], array[-1], array[0])):
        values.append({"open": inner, "wall": -inner if odd else inner, "periodic": across}[kind])
    return np.array([values[0], *array, values[1]])


def incline(h: np.ndarray, u: np.ndarray, zeta: float) -> Scene:
    """Periodic cells with h and u on an incline with friction."""
    return replace(scene_with(h, u), chute=ConstantSlope(zeta), friction=Coulomb(0.3), boundary="periodic")


@generic
def push_each(
    force: Any, f: np.ndarray, M: np.ndarray, J: np.ndarray, h: np.ndarray, dxi: float, out: np.ndarray,
    offset: np.ndarray,
) -> float:  # fmt: skip
    """Hand the impulse J of each row over to f by a force of `kinsim.kinetic.force`; returns what left the window."""
    n, gone = f.shape[1], 0.0
    row, of_M = np.zeros(n + 4), np.zeros(n + 4)
    for i in range(f.shape[0]):
        row[2 : n + 2] = f[i]
        of_M[2 : n + 2] = M[i]
        offset[i], lost = push(force, row, of_M, J[i], h[i], dxi, out, i)
        gone += lost
    return gone


def upwind(f: np.ndarray, xi: np.ndarray, lam: float, periodic: bool = False) -> np.ndarray:
    """Free upwind transport of rows of f, written down anew."""
    ends = (f[-1:], f[:1]) if periodic else (f[:1], f[-1:])
    ghosted = np.vstack([ends[0], f, ends[1]])
    at_face = np.where(xi > 0, ghosted[:-1], ghosted[1:])
    return f - lam * xi * (at_face[1:] - at_face[:-1])
