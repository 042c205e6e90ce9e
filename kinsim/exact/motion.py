"""A body under a constant drive and Coulomb friction: u' = D - sgn(u) R, at rest for |D| <= R."""

from __future__ import annotations

import math

from ..value import Number, value
from . import sliding
from .domain import NonNegative, finite, moment


@value
class Motion:
    """The velocity u(t) of u' = D - sgn(u) R and the way that it goes; call it with t to get both.

    A body that friction outweighs is at rest at `arrest` = -u0/(D - sgn(u0) R). There friction turns static: for
    |D| <= R the body stays, else it starts the other way at once with D - sgn(D) R, which nothing brakes any more. So

        u = u0 + g t                until the arrest,  g = D - sgn(u0) R,
        u = g_rest (t - arrest)     after it,          g_rest = D - min(max(D, -R), R).

    Valid for all t >= 0.

    Attributes:
        u0: Velocity at t = 0 (dimensionless, as all others).
        drive: D.
        resistance: R >= 0.
    """

    u0: Number
    drive: Number
    resistance: NonNegative

    @finite
    def __call__(self, t: float) -> tuple[float, float]:
        """u(t), and the integral of u from 0 to t.

        Raises:
            InputError: t is negative or not finite.
        """
        t = moment("Motion", t)
        g, arrest = self.braked, self.arrest
        if t <= arrest:
            return self.u0 + g * t, (self.u0 + 0.5 * g * t) * t
        free, after = sliding.at_rest(self.drive, self.resistance), t - arrest
        return free * after, 0.5 * self.u0 * arrest + 0.5 * free * after * after

    @property
    def braked(self) -> float:
        """Acceleration g before the arrest."""
        if self.u0 == 0.0:
            return sliding.at_rest(self.drive, self.resistance)
        return self.drive - math.copysign(self.resistance, self.u0)

    @property
    def arrest(self) -> float:
        """When u comes to 0: 0 if it starts there, infinity if it never does."""
        if self.u0 == 0.0:
            return 0.0
        braking = -math.copysign(1.0, self.u0) * self.braked
        return abs(self.u0) / braking if braking > 0.0 else math.inf
