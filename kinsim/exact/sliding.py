"""Coulomb friction on a mass that moves one way: the uniform acceleration m, and how long it is the right one.

(1) asks for h (u_t + u u_x + beta h_x) = h (s - F), s = sin zeta, with F = R where u > 0, -R where u < 0 and any F in
[-R, R] where u = 0. So long as u >= 0 everywhere, F = R is allowed everywhere, and the source is the constant
m = s - R; likewise m = s + R for u <= 0. With a constant source, x - m t^2/2 and u - m t obey (1) without one.
"""

from __future__ import annotations

import math


def at_rest(drive: float, resistance: float) -> float:
    """Acceleration of a body at rest that `drive` pulls at: what friction cannot hold, 0 where it can."""
    return drive - min(max(drive, -resistance), resistance)


def acceleration(lowest: float, highest: float, pull: float, resistance: float) -> float:
    """The m of velocities between `lowest` and `highest` at the start.

    Raises:
        ValueError: They have both signs, and there is friction.
    """
    if resistance == 0.0:
        return pull
    if lowest < 0.0 < highest:
        raise ValueError(
            f"velocities from {lowest:.6g} to {highest:.6g} meet friction of both signs; "
            f"add a common velocity, or take resistance = 0"
        )
    if lowest == highest == 0.0:
        return at_rest(pull, resistance)
    return pull - resistance if highest > 0.0 else pull + resistance


def until(lowest: float, highest: float, m: float, resistance: float) -> float:
    """The last time at which lowest + m t and highest + m t have the sign that `m` stands for."""
    if resistance == 0.0 or lowest == highest == 0.0:
        return math.inf
    slowest, towards = (lowest, m) if highest > 0.0 else (-highest, -m)
    return math.inf if towards >= 0.0 else slowest / -towards
