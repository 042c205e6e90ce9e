"""The parabolic cap of Savage and Hutter: a mass of finite length that slides and spreads."""

from __future__ import annotations

import math
import sys
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..model.cells import Cells
from ..value import Number, value
from . import sliding
from .domain import TOO_FAR, NonNegative, Positive, finite, held, moment, places
from .quadrature import averages
from .root import root_between


@value
class ParabolicCap:
    """(1) with a parabola of height that stays one, on dry ground; call it with (x, t) to get h, u.

        h = (h0 L/G) (1 - y^2),   u = xc' + y G',   y = (x - xc)/G, |y| <= 1,    beyond it h = u = 0,
        xc = x0 + u0 t + m t^2/2,    G'' = 2 beta h0 L/G^2,  G(0) = L,  G'(0) = 0.

    Mass: h_t + (h u)_x = 0 for any xc and G, as points of the mass keep their y. Momentum: u_t + u u_x = xc'' + y G''
    and beta h_x = -2 beta h0 L y/G^2, so that xc'' = m, the rest as above. m = s - R for motion to +x, s + R for motion
    to -x, s = sin zeta. Integrated once, G' = V sqrt(1 - L/G) with V = 2 sqrt(beta h0); with G = L cosh(w/2)^2,

        V t/L = sqrt(g (g - 1)) + ln(sqrt g + sqrt(g - 1)) = (sinh w + w)/2,  g = G/L,     G' = V tanh(w/2),

    whose root w is simple, at the start too.

    Valid as long as u keeps one sign on the whole mass, rest at a moment included: for u0 >= 0 that is
    u0 + m t >= G'(t), as the rear is the slowest. The difference is convex in t, for G'' falls. `until` is its first
    zero beyond which it is negative, or infinity. Without friction (R = 0): for all t. From rest (u0 = 0) the cap must
    run downhill as a whole, |m| >= 2 beta h0/L; else its rear starts uphill, and `until` = 0.

    Source: S. B. Savage and K. Hutter, The motion of a finite mass of granular material down a rough incline, J. Fluid
    Mech. 199 (1989) 177, the similarity solution with a parabola; w is ours.

    Attributes:
        h0: Height of the top at t = 0, > 0 (dimensionless).
        length: L, half the length of the cap at t = 0, > 0 (dimensionless).
        beta: As in (1), > 0.
        pull: s = sin zeta (dimensionless).
        resistance: R = cos zeta tan delta >= 0 (dimensionless).
        u0: Velocity at t = 0 (dimensionless).
        x0: The middle at t = 0.
    """

    h0: Positive
    length: Positive
    beta: Positive
    pull: Number = 0.0
    resistance: NonNegative = 0.0
    u0: Number = 0.0
    x0: Number = 0.0

    def __post_init__(self) -> None:
        self.until  # noqa: B018

    @finite
    def __call__(self, x: ArrayLike, t: float) -> tuple[Array, Array]:
        """Height and velocity at the places `x` at the time `t`, each of the shape of `x`.

        Raises:
            InputError: t is not between 0 and `until`, or an x is not a number.
        """
        t = moment("ParabolicCap", t, self.until)
        middle, half, spreading = self.shape(t)
        y = (places("ParabolicCap", x) - middle) / half
        h = np.maximum(self.h0 * (self.length / half) * ((1.0 - y) * (1.0 + y)), 0.0)
        return h, np.where(h > 0.0, self.u0 + self.m * t + y * spreading, 0.0)

    @finite
    def averages(self, cells: Cells, t: float) -> tuple[Array, Array]:
        """Averages of h and of q = h u over each of the `cells` at the time `t`, exact, each of shape (cells.count,).

        Raises:
            InputError: t is not between 0 and `until`.
        """
        middle, half, _ = self.shape(t)
        return averages(lambda x: self(x, t), (middle - half, middle + half), cells)

    @finite
    def shape(self, t: float) -> tuple[float, float, float]:
        """The middle xc, half the length G and G' at the time `t`.

        Raises:
            InputError: t is not between 0 and `until`.
        """
        t = moment("ParabolicCap", t, self.until)
        target = 2.0 * self._spread * t / self.length
        w = root_between(lambda w: (math.sinh(w) + w) - target, 0.0, math.asinh(target))
        middle = self.x0 + (self.u0 + 0.5 * self.m * t) * t
        return middle, self.length * math.cosh(0.5 * w) ** 2, self._spread * math.tanh(0.5 * w)

    @cached_property
    def m(self) -> float:
        """Acceleration of the middle (dimensionless)."""
        return sliding.acceleration(self.u0, self.u0, self.pull, self.resistance)

    @cached_property
    def until(self) -> float:
        """The last time at which the solution is valid; infinity if it always is."""
        if self.resistance == 0.0:
            return math.inf
        towards = -1.0 if self.u0 < 0.0 or (self.u0 == 0.0 and self.m < 0.0) else 1.0
        unit = 0.5 * self.length / self._spread
        u0, m = towards * self.u0 / self._spread, towards * self.m / self._spread * unit
        if not (held(u0, m, unit) and (self.m == 0.0 or abs(m) >= max(u0, 1.0) * sys.float_info.min)):
            raise ValueError(TOO_FAR)  # so that u0/m can be told from infinity below

        def margin(w: float) -> float:
            """The rear's velocity u0 + m t - G' at t = unit (sinh w + w), over V."""
            return u0 + m * (math.sinh(w) + w) - math.tanh(0.5 * w)

        if m > 0.0:
            steepest = 0.5 / math.sqrt(m)  # cosh(w/2)^2 where m = G''
            last = 2.0 * math.acosh(max(math.sqrt(steepest), 1.0))
        elif m < 0.0:
            last = math.asinh(-u0 / m)
        else:
            last = 2.0 * math.atanh(u0) if u0 < 1.0 else math.inf
        if math.isinf(last) or (m > 0.0 and margin(last) >= 0.0):
            return math.inf
        if u0 == 0.0:
            return 0.0
        w = root_between(margin, 0.0, last)
        return unit * (math.sinh(w) + w)

    @property
    def _spread(self) -> float:
        """V, the speed that G' tends to."""
        return 2.0 * (math.sqrt(self.beta) * math.sqrt(self.h0))
