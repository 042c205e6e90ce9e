"""Cells that leave the ground: where a chute falls away faster than the mass, cos zeta + eta kappa u^2 < 0."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..balance.stages import Array
from ..checkpoint import Kept
from ..model.chute import SmoothChute
from ..model.ground import Smooth
from ..scene import Scene

LIFT_COLUMNS = {
    "lifted": "most cells at once that left the ground since the row before",
    "lifted_from": "the leftmost x where a cell left the ground so far, NaN if none did",
    "lifted_to": "the rightmost x where a cell left the ground so far, NaN if none did",
    "lifted_since": "when a cell left the ground first, NaN if none did",
    "normal_force": "least normal force cos zeta + eta kappa u^2 so far",
}
"""Further columns of a run on a smooth chute with eta > 0."""

THIN = 1e-3
"""Cells lower than this share of the highest one are not counted: their velocities mean little."""


class Grounded:
    """The watch over a scene in which nothing can leave the ground."""

    def note(self, t: float, h: Array, q: Array) -> bool:
        """Look at the state (h, q) at the time t; says whether the run is to stop because of it."""
        return False

    def row(self) -> dict[str, float]:
        """The columns for the ledger."""
        return {}

    @property
    def words(self) -> str:
        """What was seen, or nothing."""
        return ""

    def kept(self) -> Kept:
        """What was seen so far."""
        return {}

    def restore(self, kept: Kept) -> None:
        """Go on from there."""


class Lift(Grounded):
    """The watch over a smooth chute."""

    def __init__(self, ground: Smooth, x: Array, strict: bool) -> None:
        self._ground, self._x, self._strict = ground, x, strict
        self._most = self._so_far = 0
        self._from = self._to = self._since = math.nan
        self._least = math.inf

    def note(self, t: float, h: Array, q: Array) -> bool:
        thick, normal = normal_force(self._ground, h, q)
        self._least = min(self._least, float(normal[thick].min(initial=math.inf)))
        up = np.flatnonzero(thick & (normal < 0.0))
        if not up.size:
            return False
        self._most, self._so_far = max(self._most, up.size), max(self._so_far, up.size)
        self._from = float(np.fmin(self._from, self._x[up[0]]))
        self._to = float(np.fmax(self._to, self._x[up[-1]]))
        self._since = float(np.fmin(self._since, t))
        return self._strict

    def row(self) -> dict[str, float]:
        least = self._least if self._least < math.inf else float(np.min(self._ground.cos))  # of a mass at rest
        row = dict(zip(LIFT_COLUMNS, (self._most, self._from, self._to, self._since, least), strict=True))
        self._most = 0
        return row

    @property
    def words(self) -> str:
        if math.isnan(self._since):
            return ""
        where = f"x = {self._from:.4g}" + (f" to {self._to:.4g}" if self._to > self._from else "")
        many = "1 cell" if self._so_far == 1 else f"up to {self._so_far} cells"
        return (
            f"{many} left the ground, first at t = {self._since:.4g}, in {where}, where no friction acts (least normal "
            f"force {self._least:.3g})"
        )

    def kept(self) -> Kept:
        seen = (self._most, self._so_far, self._from, self._to, self._since, self._least)
        return {"seen": np.array(seen, dtype=float)}

    def restore(self, kept: Kept) -> None:
        most, so_far, self._from, self._to, self._since, self._least = kept["seen"].tolist()
        self._most, self._so_far = int(most), int(so_far)


def normal_force(ground: Smooth, h: Array, q: Array) -> tuple[NDArray[np.bool_], Array]:
    """Which cells count, and cos zeta + eta kappa u^2 in them, of states of shape (nx,)."""
    thick = h > THIN * h.max()
    u = np.divide(q, h, out=np.zeros_like(q), where=thick)
    return thick, ground.cos + ground.bend * u * u


def lift_of(scene: Scene) -> Grounded:
    """The watch that a scene needs."""
    chute, ground = scene.chute, scene.ground
    if not (isinstance(chute, SmoothChute) and isinstance(ground, Smooth) and ground.bends):
        return Grounded()
    return Lift(ground, scene.x, chute.lifting == "stop")
