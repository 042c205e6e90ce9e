"""Cells that leave the ground: where a chute falls away faster than the mass, cos zeta + eta kappa u^2 < 0."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model.ground import Smooth
from ..scene import Scene
from ..solver.march import LIFT_EVER, LIFT_FROM, LIFT_LEAST, LIFT_MOST, LIFT_SINCE, LIFT_TO, THIN

LIFT_COLUMNS = {
    "lifted": "most cells at once that left the ground since the row before",
    "lifted_from": "the leftmost x where a cell left the ground so far, NaN if none did",
    "lifted_to": "the rightmost x where a cell left the ground so far, NaN if none did",
    "lifted_since": "when a cell left the ground first, NaN if none did",
    "normal_force": "least normal force cos zeta + eta kappa u^2 so far",
}
"""Further columns of a run on a smooth chute with eta > 0."""


def lifts(scene: Scene) -> bool:
    """Whether the mass could leave the ground of a scene."""
    return scene.ground.bends


def lift_row(scene: Scene, seen: Array) -> dict[str, float]:
    """The columns for the ledger, of what a march has seen."""
    assert isinstance(scene.ground, Smooth)
    least = seen[LIFT_LEAST] if seen[LIFT_LEAST] < math.inf else float(np.min(scene.ground.cos))  # of a mass at rest
    where = [math.nan if not math.isfinite(at) else float(scene.x[int(at)]) for at in seen[[LIFT_FROM, LIFT_TO]]]
    since = seen[LIFT_SINCE] if seen[LIFT_SINCE] < math.inf else math.nan
    return dict(zip(LIFT_COLUMNS, (float(seen[LIFT_MOST]), *where, float(since), float(least)), strict=True))


def lift_words(scene: Scene, seen: Array) -> str:
    """What was seen of cells that left the ground, or nothing."""
    if not (lifts(scene) and seen[LIFT_EVER] > 0.0):
        return ""
    row = lift_row(scene, seen)
    first, last, many = row["lifted_from"], row["lifted_to"], int(seen[LIFT_EVER])
    where = f"x = {first:.4g}" + (f" to {last:.4g}" if last > first else "")
    cells = "1 cell" if many == 1 else f"up to {many} cells"
    return (
        f"{cells} left the ground, first at t = {row['lifted_since']:.4g}, in {where}, where no friction acts (least "
        f"normal force {row['normal_force']:.3g})"
    )


def note_lift(scene: Scene, h: Array, q: Array, seen: Array) -> bool:
    """Count the cells of the initial state that leave the ground; whether any does."""
    if not scene.ground.bends:
        return False
    assert isinstance(scene.ground, Smooth)
    thick, normal = normal_force(scene.ground, h, q)
    seen[LIFT_LEAST] = min(seen[LIFT_LEAST], float(normal[thick].min(initial=math.inf)))
    up = np.flatnonzero(thick & (normal < 0.0))
    if up.size:
        seen[LIFT_MOST] = seen[LIFT_EVER] = up.size
        seen[LIFT_FROM], seen[LIFT_TO], seen[LIFT_SINCE] = up[0], up[-1], 0.0
    return bool(up.size)


def normal_force(ground: Smooth, h: Array, q: Array) -> tuple[NDArray[np.bool_], Array]:
    """Which cells count, and cos zeta + eta kappa u^2 in them, of states of shape (nx,)."""
    thick = h > THIN * h.max()
    u = np.divide(q, h, out=np.zeros_like(q), where=thick)
    return thick, ground.cos + ground.bend * u * u
