"""A uniform layer that slides, stops and may slide back."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..model.cells import Cells
from ..value import Number, value
from .domain import NonNegative, Positive, finite, moment, places
from .motion import Motion
from .quadrature import known


@value
class UniformSlide:
    """(1) with the same h and u everywhere; call it with (x, t) to get h, u.

    Nothing depends on x, so that h stays and u' = s - sgn(u) R, s = sin zeta. With u0 > 0 and s < R the layer comes to
    rest at `arrest` = u0/(R - s). It stays for |s| <= R; on ground that falls to the left more steeply than friction
    holds (s < -R) it starts at once to slide back with s + R. Mirrored for u0 < 0. See `kinsim.exact.motion`.

    Valid for all x and t >= 0.

    Source: (1) of the paper without x, and its Definition 1 at u = 0.

    Attributes:
        u0: Velocity at t = 0 (dimensionless).
        pull: s = sin zeta (dimensionless).
        resistance: R = cos zeta tan delta >= 0 (dimensionless).
        h: The height, > 0 (dimensionless).
    """

    u0: Number
    pull: Number
    resistance: NonNegative = 0.0
    h: Positive = 1.0

    @finite
    def __call__(self, x: ArrayLike, t: float) -> tuple[Array, Array]:
        """Height and velocity at the places `x` at the time `t`, each of the shape of `x`.

        Raises:
            InputError: t is negative or not finite, or an x is not a number.
        """
        shape = places("UniformSlide", x).shape
        return np.full(shape, self.h), np.full(shape, self.motion(moment("UniformSlide", t))[0])

    @finite
    def averages(self, cells: Cells, t: float) -> tuple[Array, Array]:
        """Averages of h and of q = h u over each of the `cells` at the time `t`, exact, each of shape (cells.count,).

        Raises:
            InputError: t is negative or not finite.
        """
        known(cells)
        h, u = self(cells.x, t)
        return h, h * u

    @property
    def motion(self) -> Motion:
        """u(t), and the time of the arrest."""
        return Motion(self.u0, self.pull, self.resistance)
