"""The axes of the atlas: what is made extreme, and how far."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..errors import InputError
from .setting import Setting


@dataclass(frozen=True)
class Axis:
    """Values of one field of a `Setting`.

    Attributes:
        words: What it is, for people.
        field: The field.
        values: From one end to the other.
        forced: Whether the CFL bound may be broken.
        labels: How the values are written, if not as numbers.
    """

    words: str
    field: str
    values: Sequence[Any]
    forced: bool = False
    labels: Sequence[str] | None = None

    def at(self, setting: Setting, value: Any) -> Setting:
        """The setting with this value."""
        return replace(setting, **{self.field: value})

    def label(self, number: int) -> str:
        """How value `number` is written."""
        return self.labels[number] if self.labels else f"{self.values[number]:.4g}"


DEGREES = (-89.99, -89.0, -60.0, -20.0, 0.0, 5.0, 20.0, 60.0, 85.0, 89.0, 89.99)
FRICTION = (0.0, 1e-12, 0.05, 0.1, 0.3, 1.0, math.radians(85), math.radians(89.99))

AXES = {
    "courant": Axis("Courant number", "number", (0.01, 0.1, 0.3, 0.49, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.01, 1.1, 1.2,
                    1.5, 2.0, 3.0), forced=True),
    "nodes": Axis("velocity nodes", "nodes", tuple(2**power for power in range(1, 13))),
    "height": Axis("height", "scale", (0.0, 1e-300, 1e-200, 1e-100, 1e-30, 1e-12, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e12)),
    "ratio": Axis("ratio of neighbours", "ratio", (1.0, 1e3, 1e6, 1e9, 1e12, 1e20, 1e50, 1e100, 1e200, 1e300)),
    "froude": Axis("u/c", "froude", (-0.0, 5e-324, 1e-300, 1e-100, 1e-8, 0.1, 1.0, 1e1, 1e2, 1e4, 1e6, 1e8)),
    "epsilon": Axis("epsilon, for beta", "epsilon", (1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12)),
    "zeta": Axis("zeta", "zeta", tuple(math.radians(angle) for angle in DEGREES),
                 labels=[f"{angle:g}\N{DEGREE SIGN}" for angle in DEGREES]),
    "delta": Axis("delta, with zeta = 0.1", "delta", FRICTION,
                  labels=["0", "1e-12", "0.05", "zeta", "0.3", "1", "85\N{DEGREE SIGN}", "89.99\N{DEGREE SIGN}"]),
    "dx": Axis("dx: velocity cells per pull", "dx", (1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6)),
    "mass": Axis("mass", "mass", ("hump", "one cell", "none"), labels=("hump", "one cell", "none")),
    "cells": Axis("cells", "count", (2, 3, 4, 5, 8, 40, 400)),
    "steps": Axis("steps, times those of other axes", "times", (0.05, 0.5, 5.0, 50.0, 500.0, 5000.0)),
}  # fmt: skip
"""By name."""

USUAL = tuple(name for name in AXES if name != "steps")
"""Those that take seconds."""


def axis(name: str) -> Axis:
    """The axis called `name`.

    Raises:
        InputError: There is none.
    """
    if name not in AXES:
        raise InputError(f"atlas: axis {name!r} is unknown; take {', '.join(AXES)}")
    return AXES[name]
