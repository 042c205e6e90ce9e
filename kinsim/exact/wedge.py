"""A wedge of constant slope, up to its toe on dry ground, that slides as one body, stops and may slide back."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..model.cells import Cells
from ..value import Number, value
from .domain import NonNegative, Positive, finite, moment, places
from .motion import Motion
from .quadrature import averages


@value
class SlidingWedge:
    """(1) with a height that is linear in x and one velocity; call it with (x, t) to get h, u.

        h = max(0, a + b (x - X)),  X = int_0^t u dt,    u' = s - beta b - sgn(u) R,  s = sin zeta:

    h_t + u h_x = b (-u) + u b = 0, and beta h_x = beta b is the same everywhere, so that the velocity stays uniform.
    The wedge is arrested for ever iff |s - beta b| <= R, which is Definition 1; else it turns, see
    `kinsim.exact.motion`.

    Where the line would go below h = 0 the ground is dry: the toe, at x = X - a/b, moves with u like all of the wedge.
    There h is continuous and so are h u and h u^2 + beta h^2/2, so that no jump needs a condition and (1) holds in the
    weak sense across it. The toe neither runs ahead nor lags behind, as beta h_x is the same there as elsewhere: what
    runs onto dry ground in a dam break is a front that starts from a jump.

    Valid for all x and t >= 0. u = 0 where h = 0.

    Source: derived above; with b = 0 it is `UniformSlide`.

    Attributes:
        a: Height at x = 0, t = 0 (dimensionless).
        b: Slope h_x where it is wet (dimensionless).
        u0: Velocity at t = 0 (dimensionless).
        beta: As in (1), > 0.
        pull: s = sin zeta (dimensionless).
        resistance: R = cos zeta tan delta >= 0 (dimensionless).
    """

    a: Number
    b: Number
    u0: Number
    beta: Positive
    pull: Number = 0.0
    resistance: NonNegative = 0.0

    @finite
    def __call__(self, x: ArrayLike, t: float) -> tuple[Array, Array]:
        """Height and velocity at the places `x` at the time `t`, each of the shape of `x`.

        Raises:
            InputError: t is negative or not finite, or an x is not a number.
        """
        there = places("SlidingWedge", x)
        u, way = self.motion(moment("SlidingWedge", t))
        h = np.maximum(0.0, self.a + self.b * (there - way))
        return h, np.where(h > 0.0, u, 0.0)

    @finite
    def averages(self, cells: Cells, t: float) -> tuple[Array, Array]:
        """Averages of h and of q = h u over each of the `cells` at the time `t`, exact, each of shape (cells.count,).

        Raises:
            InputError: t is negative or not finite.
        """
        return averages(lambda x: self(x, t), (self.toe(t),), cells)

    def toe(self, t: float) -> float:
        """Where the dry ground begins at the time `t`; infinity for b = 0.

        Raises:
            InputError: t is negative or not finite.
        """
        way = self.motion(moment("SlidingWedge", t))[1]
        with np.errstate(all="ignore"):
            return float(way - np.float64(self.a) / self.b) if self.b else math.inf

    @property
    def motion(self) -> Motion:
        """u(t), the way X(t), and the time of the arrest."""
        return Motion(self.u0, self.pull - self.beta * self.b, self.resistance)
