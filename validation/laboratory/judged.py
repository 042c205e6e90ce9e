"""Runs that start from an exact solution and are judged by it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from kinsim import Cells, ConstantSlope, Coulomb, Profile, Run, Scene


def scene_of(exact: Any, cells: Cells, beta: float) -> Scene:
    """The exact solution at t = 0 as cell averages, on its own ground."""
    h, q = exact.averages(cells, 0.0)
    zeta = math.asin(getattr(exact, "pull", 0.0))
    friction = Coulomb(math.atan(getattr(exact, "resistance", 0.0) / math.cos(zeta)))
    heap = Profile(h, np.divide(q, h, out=np.zeros_like(h), where=h > 0))
    return Scene(cells=cells, heap=heap, chute=ConstantSlope(zeta), friction=friction, epsilon=beta / math.cos(zeta))


def error(exact: Any, run: Run, inner: tuple[float, float]) -> float:
    """L1 error of h at the end of a run, between two places that no open end has reached."""
    keep = (run.x > inner[0]) & (run.x < inner[1])
    h, _ = exact.averages(run.scene.cells, float(run.t[-1]))
    return float(np.abs(run.h[-1] - h)[keep].sum() * run.scene.cells.dx)
