"""A wedge of constant slope that slides as one body, stops and may slide back."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..errors import InputError
from ..model.cells import Cells
from ..value import Number, value
from .domain import Array, NonNegative, Positive, finite, moment, places
from .motion import Motion
from .quadrature import averages, cell_edges


@value
class SlidingWedge:
    """(1) with a height that is linear in x and one velocity; call it with (x, t) to get h, u.

        h = a + b (x - X),  X = int_0^t u dt,    u' = s - beta b - sgn(u) R,  s = sin zeta:

    h_t + u h_x = b (-u) + u b = 0, and beta h_x = beta b is the same everywhere, so that the velocity stays uniform.
    The wedge is arrested for ever iff |s - beta b| <= R, which is Definition 1; else it turns, see
    `kinsim.exact.motion`.

    Valid for all t >= 0 and all x with h >= 0. The line goes on below h = 0 only on paper: a toe on dry ground would
    collapse or run, so that other x are refused. u = 0 where h = 0.

    Source: derived above; with b = 0 it is `UniformSlide`.

    Attributes:
        a: Height at x = 0, t = 0 (dimensionless).
        b: Slope h_x (dimensionless).
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
            InputError: t is negative or not finite, an x is not a number, or h < 0 there.
        """
        there = places("SlidingWedge", x)
        u, way = self.motion(moment("SlidingWedge", t))
        h: Array = self.a + self.b * (there - way)
        if (h < 0.0).any():
            outside = float(there[h < 0.0].flat[0])
            raise InputError(f"SlidingWedge: h < 0 at x = {outside:.6g}, t = {t:.6g}; stay where a + b (x - X) >= 0")
        return h, np.where(h > 0.0, u, 0.0)

    @finite
    def averages(self, cells: Cells, t: float) -> tuple[Array, Array]:
        """Averages of h and of q = h u over each of the `cells` at the time `t`, exact, each of shape (cells.count,).

        Raises:
            InputError: t is negative or not finite, or h < 0 somewhere in a cell.
        """
        self(cell_edges(cells), t)
        return averages(lambda x: self(x, t), (), cells)

    @property
    def motion(self) -> Motion:
        """u(t), the way X(t), and the time of the arrest."""
        return Motion(self.u0, self.pull - self.beta * self.b, self.resistance)
