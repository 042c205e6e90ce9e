"""How steep a smooth chute is: each family gives the angle zeta and its derivative at the places x.

zeta is in radians against the horizontal, downhill to +x where it is positive; x runs along the chute.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from ..arrays import Array
from ..errors import InputError
from ..expression import check_names, evaluate
from ..value import Number, kind, value
from .slope_table import SlopePoints, SlopeTable

Angle = Annotated[Number, Field(ge=-math.radians(80.0), le=math.radians(80.0))]
Length = Annotated[Number, Field(gt=0)]

STEEPEST = math.radians(80.0)
"""A steeper chute is refused: beta would be all but zero."""

FINE = 1e-3
"""A formula is differentiated over so many of its own lengths to each side."""


@value
class Bend:
    """From the slope `upper` to `lower` between the places `start` and `end`, by a quintic with a continuous curvature.

    zeta = upper + (lower - upper) (10 y^3 - 15 y^4 + 6 y^5), y = (x - start)/(end - start).
    """

    upper: Angle
    lower: Angle
    start: Number
    end: Number
    kind: Literal["bend"] = kind("bend")

    def __post_init__(self) -> None:
        if not self.start < self.end:
            raise ValueError(f"start = {self.start:g} is not below end = {self.end:g}; exchange or change them")

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """zeta and its derivative at `x`."""
        length, turn = self.end - self.start, self.lower - self.upper
        y = np.clip((x - self.start) / length, 0.0, 1.0)
        zeta = self.upper + turn * (y * y * y * (10.0 + y * (6.0 * y - 15.0)))
        return zeta, turn / length * (30.0 * (y * (1.0 - y)) ** 2)


@value
class Exponential:
    """zeta = top exp(-x/length), as in the chute of Hutter and Koch (1991)."""

    top: Angle
    length: Length
    kind: Literal["exponential"] = kind("exponential")

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """zeta and its derivative at `x`."""
        zeta = self.top * np.exp(-x / self.length)
        return zeta, -zeta / self.length


@value
class Crest:
    """From the slope `before` to the steeper `after` around `place`: zeta = their mean + half their difference tanh y.

    y = (x - place)/width.
    """

    before: Angle
    after: Angle
    place: Number = 0.0
    width: Length = 1.0
    kind: Literal["crest"] = kind("crest")

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """zeta and its derivative at `x`."""
        y = np.tanh((x - self.place) / self.width)
        half = 0.5 * (self.after - self.before)
        return 0.5 * (self.before + self.after) + half * y, half / self.width * (1.0 - y * y)


@value
class Bowl:
    """A valley around `place` whose sides become `steepest`: zeta = -steepest tanh((x - place)/width)."""

    steepest: Angle
    place: Number = 0.0
    width: Length = 1.0
    kind: Literal["bowl"] = kind("bowl")

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """zeta and its derivative at `x`."""
        return Crest(self.steepest, -self.steepest, self.place, self.width)(x)


@value
class Arc:
    """An arc of a circle: zeta = middle - (x - place)/radius; a negative radius makes a hill of it."""

    radius: Number
    middle: Angle = 0.0
    place: Number = 0.0
    kind: Literal["arc"] = kind("arc")

    def __post_init__(self) -> None:
        if self.radius == 0.0:
            raise ValueError("radius = 0 is no circle; give one that is not 0")

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """zeta and its derivative at `x`."""
        return self.middle - (x - self.place) / self.radius, np.full_like(x, -1.0 / self.radius)


@value
class SlopeFormula:
    """A formula in x, for example ``zeta = "0.1 + 0.35*sin(x)"`` (see `kinsim.expression`).

    Its derivative is taken by central differences of fourth order over thousandths of `length`, beyond the ends of the
    domain, too.
    """

    zeta: str
    length: Length = 1.0
    kind: Literal["expression"] = kind("expression")

    def __post_init__(self) -> None:
        check_names(self.zeta)

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """zeta and its derivative at `x`."""
        step = FINE * self.length
        near = evaluate(self.zeta, x + step) - evaluate(self.zeta, x - step)
        far = evaluate(self.zeta, x + 2.0 * step) - evaluate(self.zeta, x - 2.0 * step)
        return evaluate(self.zeta, x), (8.0 * near - far) / (12.0 * step)


Slope = Annotated[
    Bend | Exponential | Crest | Bowl | Arc | SlopeFormula | SlopeTable | SlopePoints, Field(discriminator="kind")
]


def angles(slope: Slope, x: Array) -> tuple[Array, Array]:
    """zeta and its derivative at the places `x`.

    Raises:
        InputError: It is steeper than 80 degrees at one of them, or no number; the message names the place.
    """
    found = slope(x)
    for what, values in zip(("zeta", "its derivative"), found, strict=True):
        bad = ~np.isfinite(values) if what != "zeta" else ~(np.abs(values) <= STEEPEST * (1.0 + 1e-12))
        if bad.any():
            i = int(np.flatnonzero(bad)[0])
            remedy = "chutes are at most 80 degrees (1.396) steep" if what == "zeta" else "give a smooth one"
            raise InputError(f"chute: {what} is {values[i]:.4g} at x = {x[i]:g}; {remedy}")
    return found
