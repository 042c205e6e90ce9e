"""The exact solution of the frictionless Riemann problem, all wave patterns."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array
from ..model.cells import Cells
from ..value import Number, value
from . import jump
from .domain import TOO_FAR, NonNegative, Positive, finite, held, moment, places
from .quadrature import averages
from .root import root_between


@value
class Riemann:
    """(1) without a source, and with two constant states that meet at x0 at t = 0; call it with (x, t) to get h, u.

    h_t + q_x = 0, q_t + (q^2/h + beta h^2/2)_x = 0: the shallow water equations with beta for gravity, so that the
    characteristic speeds are u -+ a, a = sqrt(beta h). Each side K is joined to the middle state (h*, u*) by

    - a fan where h* <= h_K: u -+ 2 a keeps its value on the side of K, and u -+ a = (x - x0)/t inside the fan;
    - a shock where h* > h_K: speed u_K -+ sqrt(beta h* (h* + h_K) / (2 h_K)) by Rankine and Hugoniot;

    which makes u* = u_left - phi(h*, h_left) = u_right + phi(h*, h_right) with phi(h, h_K) = 2 (a - a_K) in the first
    and (h - h_K) sqrt(beta (1/h + 1/h_K)/2) in the second case. The difference increases with h*, so that there is one
    root. If u_right - u_left >= 2 (a_left + a_right), or a side is dry, fans end in dry ground with speed u_K +- 2 a_K.

    Valid for all x and t >= 0, for h >= 0 on both sides and beta > 0. Dry ground has u = 0, whatever was given.

    Source: J. J. Stoker, Water Waves (1957), ch. 10; E. F. Toro, Shock-Capturing Methods for Free-Surface Shallow
    Flows (2001), ch. 5 and 6; section 4 of the paper for h_left > h_right, u = 0.

    Attributes:
        h_left, u_left, h_right, u_right: The two states (dimensionless).
        beta: As in (1), > 0.
        x0: Where they meet; x0 itself belongs to the left.
    """

    h_left: NonNegative
    u_left: Number
    h_right: NonNegative
    u_right: Number
    beta: Positive
    x0: Number = 0.0

    def __post_init__(self) -> None:
        if not held(*self.middle, *self.speeds):
            raise ValueError(TOO_FAR)

    @finite
    def __call__(self, x: ArrayLike, t: float) -> tuple[Array, Array]:
        """Height and velocity at the places `x` at the time `t`, each of the shape of `x`.

        Raises:
            InputError: t is negative or not finite, or an x is not a number.
        """
        there = places("Riemann", x)
        piece = np.searchsorted(self._ends(t), there, side="left")
        h, u = np.empty(there.shape), np.empty(there.shape)
        for number in range(5):
            inside = piece == number
            h[inside], u[inside] = self._state(number, there[inside], t)
        return h, u

    @finite
    def averages(self, cells: Cells, t: float) -> tuple[Array, Array]:
        """Averages of h and of q = h u over each of the `cells` at the time `t`, exact, each of shape (cells.count,).

        Raises:
            InputError: t is negative or not finite.
        """
        return averages(lambda x: self(x, t), self._ends(t).tolist(), cells)

    @cached_property
    def middle(self) -> tuple[float, float]:
        """The state (h*, u*) between the two waves, (0, 0) where there is none."""
        a_left, a_right = self._celerity(self.h_left), self._celerity(self.h_right)
        rise = self.u_right - self.u_left
        if min(self.h_left, self.h_right) == 0.0 or rise >= 2.0 * (a_left + a_right):
            return 0.0, 0.0
        low, high = sorted((self.h_left, self.h_right))

        def excess(h: float) -> float:
            return (self._phi(h, self.h_left) + self._phi(h, self.h_right)) + rise

        if low == high and rise == 0.0:
            h = low
        elif excess(low) >= 0.0:  # two fans
            root = (0.5 * (a_left + a_right) - 0.25 * rise) / math.sqrt(self.beta)
            h = root * root
        else:
            while excess(high) < 0.0:
                high *= 2.0
            if math.isinf(high):
                raise ValueError(TOO_FAR)
            h = root_between(excess, low, high)
        return h, 0.5 * ((self.u_left + self.u_right) + (self._phi(h, self.h_right) - self._phi(h, self.h_left)))

    @cached_property
    def speeds(self) -> tuple[float, float, float, float]:
        """Begin and end of the left wave, then of the right one; both are equal for a shock."""
        h, u = self.middle
        left, right = (self._wave(h_side, u_side, h, u, sign) for h_side, u_side, sign in (
            (self.h_left, self.u_left, -1.0), (self.h_right, self.u_right, 1.0)))  # fmt: skip
        if self.h_left == 0.0:
            left = (right[1], right[1])
        if self.h_right == 0.0:
            right = (left[1], left[1])
        return left[0], left[1], right[1], right[0]

    @cached_property
    def velocities(self) -> tuple[float, float]:
        """Lowest and highest u on wet points, at all times t > 0; at a front on dry ground, its speed."""
        h, u = self.middle
        ends = (u, u) if h > 0.0 else (self.speeds[1], self.speeds[2])
        left = (self.u_left, ends[0]) if self.h_left > 0.0 else ()
        right = (ends[1], self.u_right) if self.h_right > 0.0 else ()
        return min((*left, *right), default=0.0), max((*left, *right), default=0.0)

    def _wave(self, h_side: float, u_side: float, h: float, u: float, sign: float) -> tuple[float, float]:
        """Outer and inner speed of the wave that joins (h_side, u_side) to the middle (h, u)."""
        if h > h_side:
            shock = u_side + sign * jump.speed(h, h_side, self.beta)
            return shock, shock
        a_side = self._celerity(h_side)
        inner = u + sign * self._celerity(h) if h > 0.0 else u_side - sign * 2.0 * a_side
        return u_side + sign * a_side, inner

    def _phi(self, h: float, h_side: float) -> float:
        if h <= h_side:
            return 2.0 * (self._celerity(h) - self._celerity(h_side))
        return jump.difference(h, h_side, self.beta)

    def _celerity(self, h: float) -> float:
        """a = sqrt(beta h), whose product may leave floating point where its roots do not."""
        return math.sqrt(self.beta) * math.sqrt(h)

    def _ends(self, t: float) -> Array:
        """Where the five pieces (left, left wave, middle, right wave, right) meet at `t`, ascending, shape (4,)."""
        return np.maximum.accumulate(self.x0 + moment("Riemann", t) * np.array(self.speeds))

    def _state(self, piece: int, x: Array, t: float) -> tuple[Array, Array]:
        """h, u of one piece, continued to all of `x`."""
        if piece in (1, 3) and t > 0.0:
            h_side, u_side, sign = (self.h_left, self.u_left, -1.0) if piece == 1 else (self.h_right, self.u_right, 1.0)
            ray = (x - self.x0) / t
            far = u_side - sign * 2.0 * self._celerity(h_side)
            a = np.maximum(sign * (ray - far), 0.0) / 3.0
            return (a / math.sqrt(self.beta)) ** 2, np.where(a > 0.0, (far + 2.0 * ray) / 3.0, 0.0)
        h, u = {0: (self.h_left, self.u_left), 4: (self.h_right, self.u_right)}.get(piece, self.middle)
        return np.full(x.shape, h), np.full(x.shape, u if h > 0.0 else 0.0)
