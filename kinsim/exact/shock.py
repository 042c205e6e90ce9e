"""A shock that travels between two uniform layers on an incline with friction."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..model.cells import Cells
from ..value import Number, value
from . import jump, sliding
from .domain import TOO_FAR, NonNegative, Positive, finite, held, moment, places
from .quadrature import averages


@value
class TravellingShock:
    """(1) with two uniform layers and the one shock between them; call it with (x, t) to get h, u.

    The layers slide with u_left + m t and u_right + m t, m = s - R for motion to +x and s + R for motion to -x,
    s = sin zeta. The shock is at x0 + S t + m t^2/2. In the frame that moves with m t it is at rest in time, where
    Rankine and Hugoniot, S [h] = [h u] and S [h u] = [h u^2 + beta h^2/2], have the solutions

        u_left - u_right = |h_left - h_right| sqrt(beta (1/h_left + 1/h_right)/2),
        S = u_low + sign sqrt(beta h_high (h_high + h_low)/(2 h_low)),

    high and low the higher and the lower layer, sign = 1 if the left one is higher (the shock runs to +x into the right
    one), else -1; with this sign the characteristics of the shock's own family run into it (Lax). Accelerating frames
    change neither jump nor Lax, as the source is bounded.

    Valid as long as both layers keep one sign of u, rest at a moment included: until t = `until`, infinite if m speeds
    the mass up or R = 0. Layers of both signs with friction are refused at once. x = x0 + S t + m t^2/2 itself belongs
    to the left.

    Source: J. J. Stoker, Water Waves (1957), ch. 10, for m = 0; the frame as in `AcceleratedRiemann`.

    Attributes:
        h_left, h_right: Heights, > 0 and unlike (dimensionless).
        u_left: Velocity of the left layer at t = 0 (dimensionless); that of the right one follows.
        beta: As in (1), > 0.
        pull: s = sin zeta (dimensionless).
        resistance: R = cos zeta tan delta >= 0 (dimensionless).
        x0: Where the shock is at t = 0.
    """

    h_left: Positive
    u_left: Number
    h_right: Positive
    beta: Positive
    pull: Number = 0.0
    resistance: NonNegative = 0.0
    x0: Number = 0.0

    def __post_init__(self) -> None:
        if self.h_left == self.h_right:
            raise ValueError(f"h_left = h_right = {self.h_left:g} leaves no shock; take unlike ones, or UniformSlide")
        if not (held(self.u_right, self.speed) and held(self.m)):
            raise ValueError(TOO_FAR)

    @finite
    def __call__(self, x: ArrayLike, t: float) -> tuple[Array, Array]:
        """Height and velocity at the places `x` at the time `t`, each of the shape of `x`.

        Raises:
            InputError: t is not between 0 and `until`, or an x is not a number.
        """
        t = moment("TravellingShock", t, self.until)
        left = places("TravellingShock", x) <= self.place(t)
        u = np.where(left, self.u_left, self.u_right) + self.m * t
        return np.where(left, self.h_left, self.h_right), u

    @finite
    def averages(self, cells: Cells, t: float) -> tuple[Array, Array]:
        """Averages of h and of q = h u over each of the `cells` at the time `t`, exact, each of shape (cells.count,).

        Raises:
            InputError: t is not between 0 and `until`.
        """
        return averages(lambda x: self(x, t), (self.place(t),), cells)

    @cached_property
    def u_right(self) -> float:
        """Velocity of the right layer at t = 0."""
        return self.u_left - jump.difference(self.h_left, self.h_right, self.beta)

    @cached_property
    def speed(self) -> float:
        """S, the speed of the shock at t = 0."""
        high, low = max(self.h_left, self.h_right), min(self.h_left, self.h_right)
        u, sign = (self.u_right, 1.0) if self.h_left >= self.h_right else (self.u_left, -1.0)
        return u + sign * jump.speed(high, low, self.beta)

    @cached_property
    def m(self) -> float:
        """Acceleration of the layers and of the shock (dimensionless)."""
        return sliding.acceleration(self.u_right, self.u_left, self.pull, self.resistance)

    @cached_property
    def until(self) -> float:
        """The last time at which the solution is valid; infinity if it always is."""
        return sliding.until(self.u_right, self.u_left, self.m, self.resistance)

    def place(self, t: float) -> float:
        """Where the shock is at the time `t`."""
        t = moment("TravellingShock", t)
        return self.x0 + self.speed * t + 0.5 * self.m * t * t
