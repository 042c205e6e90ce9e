"""A chute that bends from steep to flat, as tables, and a cap that slides into it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

import kinsim
from kinsim.smooth.riccati import refuse_steep

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bend:
    """From `steep` to flat over [begin, end] by a quintic that is twice smooth; cells and a ghost at each end.

    Attributes:
        wall: Which beta a wall's ghost has: that of the "inner" cell, or that of its own "place".
    """

    left: float = 14.0
    right: float = 26.0
    count: int = 120
    begin: float = 17.5
    end: float = 21.5
    steep: float = math.radians(35)
    delta: float = math.radians(25)
    epsilon: float = 0.4
    wall: Literal["inner", "place"] = "inner"
    dx: float = field(init=False)
    x: Array = field(init=False)
    beta: Array = field(init=False)
    gamma: Array = field(init=False)
    pull: Array = field(init=False)
    resistance: Array = field(init=False)

    def __post_init__(self) -> None:
        dx = (self.right - self.left) / self.count
        x = self.left + dx * (np.arange(self.count + 2) - 0.5)
        zeta, slope = kinsim.Bend(self.steep, 0.0, self.begin, self.end)(x)
        beta = self.epsilon * np.cos(zeta)
        if self.wall == "inner":
            beta[0], beta[-1] = beta[1], beta[-2]
        tables = {"dx": dx, "x": x[1:-1], "beta": beta, "gamma": -(slope * np.tan(zeta))[1:-1],
                  "pull": np.sin(zeta)[1:-1], "resistance": (np.cos(zeta) * math.tan(self.delta))[1:-1]}  # fmt: skip
        for name, table in tables.items():
            object.__setattr__(self, name, table)
        refuse_steep(self.gamma, dx)


def cap(bend: Bend, middle: float = 16.4, half: float = 1.85, speed: float = 2.0) -> tuple[Array, Array]:
    """A parabolic cap that slides towards the bend."""
    h = np.maximum(1.0 - ((bend.x - middle) / half) ** 2, 0.0)
    return h, np.where(h > 0.0, speed, 0.0)
