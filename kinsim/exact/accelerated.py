"""Riemann problems on an incline with Coulomb friction, seen from a frame that slides along."""

from __future__ import annotations

from functools import cached_property

from numpy.typing import ArrayLike

from ..arrays import Array
from ..model.cells import Cells
from ..value import Number, value
from . import sliding
from .domain import NonNegative, finite, moment, places
from .quadrature import known
from .riemann import Riemann


@value
class AcceleratedRiemann:
    """(1) with two constant states that meet at x0 at t = 0, all sliding one way; call it with (x, t) to get h, u.

    With (H, U) the frictionless Riemann solution,

        h = H(x - m t^2/2, t),    u = U(x - m t^2/2, t) + m t,

    m = s - R for motion to +x, s + R for motion to -x, s = sin zeta: the substitution turns h_t + q_x = 0,
    q_t + (q^2/h + beta h^2/2)_x = m h into the same without m, jumps included.

    Valid as long as u keeps one sign on all wet points, rest at a moment included (see `kinsim.exact.sliding`). H and U
    depend on (x - x0)/t alone, so that the values of U on wet points do not change with time, fronts on dry ground
    included, and the last time is `until` = (slowest |U|)/|m|, infinite if m speeds the mass up. A dam that breaks
    from rest has slowest |U| = 0: only for zeta >= delta. Without friction (R = 0): for all t. Velocities of both
    signs with friction are refused at once. Dry ground has u = 0.

    Source: derived above; A. Mangeney, P. Heinrich and R. Roche, Pure Appl. Geophys. 157 (2000) 1081, for the dam that
    breaks on a dry incline.

    Attributes:
        riemann: The two states and beta (dimensionless).
        pull: s = sin zeta (dimensionless).
        resistance: R = cos zeta tan delta >= 0 (dimensionless).
    """

    riemann: Riemann
    pull: Number
    resistance: NonNegative

    def __post_init__(self) -> None:
        self.m  # noqa: B018

    @finite
    def __call__(self, x: ArrayLike, t: float) -> tuple[Array, Array]:
        """Height and velocity at the places `x` at the time `t`, each of the shape of `x`.

        Raises:
            InputError: t is not between 0 and `until`, or an x is not a number.
        """
        t = moment("AcceleratedRiemann", t, self.until)
        h, u = self.riemann(places("AcceleratedRiemann", x) - self.way(t), t)
        u[h > 0.0] += self.m * t
        return h, u

    @finite
    def averages(self, cells: Cells, t: float) -> tuple[Array, Array]:
        """Averages of h and of q = h u over each of the `cells` at the time `t`, exact, each of shape (cells.count,).

        Raises:
            InputError: t is not between 0 and `until`.
        """
        t = moment("AcceleratedRiemann", t, self.until)
        way = self.way(t)
        known(cells)
        h, q = self.riemann.averages(Cells(cells.left - way, cells.right - way, cells.count), t)
        return h, q + self.m * t * h

    @cached_property
    def m(self) -> float:
        """Acceleration of the frame (dimensionless)."""
        return sliding.acceleration(*self.riemann.velocities, self.pull, self.resistance)

    @cached_property
    def until(self) -> float:
        """The last time at which the solution is valid; infinity if it always is."""
        return sliding.until(*self.riemann.velocities, self.m, self.resistance)

    def way(self, t: float) -> float:
        """How far the frame has gone at the time `t`, m t^2/2."""
        t = moment("AcceleratedRiemann", t)
        return 0.5 * self.m * t * t
