"""Piles at rest: two straight sides, each holding a chosen share of the friction."""

from __future__ import annotations

from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from ..arrays import Array
from ..model.cells import Cells
from ..value import Number, value
from .domain import NonNegative, Positive, finite, moment, places
from .quadrature import averages

Share = Annotated[Number, Field(ge=-1, le=1)]


@value
class StaticPile:
    """A pile at rest, h h_x beta = h (s + theta R) with |theta| <= 1; call it with (x, t) to get h, u = 0.

    h = max(floor, h0 + slope (x - x0)) with slope = (s + theta_left R)/beta for x <= x0 and (s + theta_right R)/beta
    for x >= x0. With u = 0, (1) asks for beta h_x = s - F, |F| <= R, which is Definition 1 with theta = -F/R: 0 is
    a level surface, +-1 is the Coulomb bound. h is continuous, hence so is the momentum flux beta h^2/2, and kinks,
    the toes on dry ground among them, need nothing more. With the same theta on both sides the pile is straight; its
    mirror image has -s, -theta_right, -theta_left, -x0.

    Valid for all x and t >= 0. |theta| > 1 is refused, and so is a wet floor on ground that it would slide down
    (floor > 0 and |s| > R); for piles outside the bound see `random_pile`.

    Source: Definition 1 and (8) of the paper.

    Attributes:
        theta_left, theta_right: Share of the Coulomb bound on each side.
        beta: As in (1), > 0.
        pull: s = sin zeta (dimensionless).
        resistance: R = cos zeta tan delta >= 0 (dimensionless).
        h0: Height at x0, at least that of the floor (dimensionless).
        x0: Where the sides meet.
        floor: Height of the layer that the pile stands on, 0 for dry ground.
    """

    theta_left: Share
    theta_right: Share
    beta: Positive
    pull: Number = 0.0
    resistance: NonNegative = 0.0
    h0: NonNegative = 1.0
    x0: Number = 0.0
    floor: NonNegative = 0.0

    def __post_init__(self) -> None:
        if self.h0 < self.floor:
            raise ValueError(f"h0 = {self.h0:g} is below the floor {self.floor:g}; raise it, or lower the floor")
        if self.floor > 0.0 and abs(self.pull) > self.resistance:
            raise ValueError(f"a floor of height {self.floor:g} would slide: |pull| > resistance; take floor = 0")

    @finite
    def __call__(self, x: ArrayLike, t: float) -> tuple[Array, Array]:
        """Height and velocity at the places `x` at the time `t`, each of the shape of `x`.

        Raises:
            InputError: t is negative or not finite, or an x is not a number.
        """
        moment("StaticPile", t)
        off = places("StaticPile", x) - self.x0
        left, right = self.slopes
        h = np.maximum(self.floor, self.h0 + np.where(off < 0.0, left, right) * off)
        return h, np.zeros(h.shape)

    @finite
    def averages(self, cells: Cells, t: float) -> tuple[Array, Array]:
        """Averages of h and of q = 0 over each of the `cells` at the time `t`, exact, each of shape (cells.count,).

        Raises:
            InputError: t is negative or not finite.
        """
        return averages(lambda x: self(x, t), (*self.toes, self.x0), cells)

    @property
    def slopes(self) -> tuple[float, float]:
        """h_x of the left and of the right side above the floor."""
        left, right = (
            (self.pull + theta * self.resistance) / self.beta for theta in (self.theta_left, self.theta_right)
        )
        return left, right

    @cached_property
    def toes(self) -> tuple[float, float]:
        """Where the left and the right side reach the floor, infinite where they do not."""
        above = self.h0 - self.floor
        left, right = self.slopes
        return (
            self.x0 - above / left if left > 0.0 else -np.inf,
            self.x0 - above / right if right < 0.0 else np.inf,
        )
