"""The formulas of sections 3.2 and 4 exactly as printed, and the same with one misprint mended at a time.

No scheme of kinsim uses them. They are the worked example of `kinsim.crosscheck`, and the tests show with them which
printed terms are wrong.
"""

from __future__ import annotations

from math import asin, cos, pi, sin, sqrt

import numpy as np
from numpy.typing import ArrayLike

from .arrays import Array


def flux(
    h_left: ArrayLike, u_left: ArrayLike, h_right: ArrayLike, u_right: ArrayLike, beta: float
) -> tuple[Array, Array]:
    """(F^1, F^2) = (I1 + I2, I3 + I4) as printed; dry sides give nothing."""
    states = np.broadcast_arrays(h_left, u_left, h_right, u_right)
    columns = [np.ravel(state).astype(float).tolist() for state in states]
    pairs = [_printed(hl, ul, hr, ur, beta) for hl, ul, hr, ur in zip(*columns, strict=True)]
    first, second = (np.array(column).reshape(states[0].shape) for column in zip(*pairs, strict=True))
    return first, second


def _printed(h_left: float, u_left: float, h_right: float, u_right: float, beta: float) -> tuple[float, float]:
    first = second = 0.0
    if h_left > 0:
        first, second = I1(h_left, u_left, beta), I3(h_left, u_left, beta)
    if h_right > 0:
        first += I2(h_right, u_right, beta)
        second += I4(h_right, u_right, beta, u_left=u_left)
    return first, second


def I1(h: float, u: float, beta: float) -> float:
    """As printed; right."""
    a1 = -u / sqrt(2 * beta * h)
    if a1 <= -1:
        return h * u
    if a1 >= 1:
        return 0.0
    return 2 / (3 * pi) * sqrt(2 * beta) * sqrt(h) ** 3 * cos(asin(a1)) ** 3 + 2 / pi * h * u * (
        pi / 4 - asin(a1) / 2 - sin(2 * asin(a1)) / 4
    )


def I2(h: float, u: float, beta: float) -> float:
    """As printed; right."""
    a2 = -u / sqrt(2 * beta * h)
    if a2 <= -1:
        return 0.0
    if a2 >= 1:
        return h * u
    return -2 / (3 * pi) * sqrt(2 * beta) * sqrt(h) ** 3 * cos(asin(a2)) ** 3 + 2 / pi * h * u * (
        pi / 4 + asin(a2) / 2 + sin(2 * asin(a2)) / 4
    )


def I3(h: float, u: float, beta: float, *, sine_mended: bool = False, sign_mended: bool = False) -> float:
    """Printed with sin(a1) for sin(4 arcsin a1), and with minus before the cos^3 term."""
    a1 = -u / sqrt(2 * beta * h)
    if a1 <= -1:
        return h * u**2 + beta * h**2 / 2
    if a1 >= 1:
        return 0.0
    sine = sin(4 * asin(a1)) if sine_mended else sin(a1)
    sign = 1 if sign_mended else -1
    return (
        4 / pi * beta * h**2 * (pi / 16 - asin(a1) / 8 + sine / 32)
        + sign * 4 / (3 * pi) * sqrt(2 * beta) * (h * u) * sqrt(h) * cos(asin(a1)) ** 3
        + 2 / pi * h * u**2 * (pi / 4 - asin(a1) / 2 - sin(2 * asin(a1)) / 4)
    )


def I4(h: float, u: float, beta: float, *, u_left: float | None = None) -> float:
    """Printed with `u_left` of the left cell where a2 >= 1; None takes the cell's own, which is right."""
    a2 = -u / sqrt(2 * beta * h)
    if a2 <= -1:
        return 0.0
    if a2 >= 1:
        return h * (u if u_left is None else u_left) ** 2 + beta * h**2 / 2
    return (
        4 / pi * beta * h**2 * (asin(a2) / 8 + pi / 16 - sin(4 * asin(a2)) / 32)
        - 4 / (3 * pi) * sqrt(2 * beta) * (h * u) * sqrt(h) * cos(asin(a2)) ** 3
        + 2 / pi * h * u**2 * (pi / 4 + asin(a2) / 2 + sin(2 * asin(a2)) / 4)
    )


def I1_tilde(h: float, u: float, beta: float, *, bracket_mended: bool = False) -> float:
    """Middle branch printed with sin(2 arcsin)/4 outside the bracket; h is the mean height at the face."""
    a1 = -u / sqrt(2 * beta * h)
    if a1 <= -1:
        return h * u
    if a1 >= 1:
        return 0.0
    factor = 2 / pi * h * u
    sine = -sin(2 * asin(a1)) / 4
    return (
        2 / (3 * pi) * sqrt(2 * beta) * sqrt(h) ** 3 * cos(asin(a1)) ** 3
        + factor * (pi / 4 - asin(a1) / 2)
        + (factor * sine if bracket_mended else sine)
    )


def I2_tilde(h: float, u: float, beta: float, *, bracket_mended: bool = False) -> float:
    """Middle branch printed with sin(2 arcsin)/4 outside the bracket; h is the mean height at the face."""
    a2 = -u / sqrt(2 * beta * h)
    if a2 <= -1:
        return 0.0
    if a2 >= 1:
        return h * u
    factor = 2 / pi * h * u
    sine = sin(2 * asin(a2)) / 4
    return (
        -2 / (3 * pi) * sqrt(2 * beta) * sqrt(h) ** 3 * cos(asin(a2)) ** 3
        + factor * (pi / 4 + asin(a2) / 2)
        + (factor * sine if bracket_mended else sine)
    )


def I3_tilde(h: float, u: float, beta: float) -> float:
    """As printed; right."""
    a1 = -u / sqrt(2 * beta * h)
    if a1 <= -1:
        return h * u**2 + beta * h**2 / 2
    if a1 >= 1:
        return 0.0
    return (
        4 / pi * beta * h**2 * (pi / 16 - asin(a1) / 8 + sin(4 * asin(a1)) / 32)
        + 4 / (3 * pi) * sqrt(2 * beta) * sqrt(h) ** 3 * u * cos(asin(a1)) ** 3
        + 2 / pi * h * u**2 * (pi / 4 - asin(a1) / 2 - sin(2 * asin(a1)) / 4)
    )


def I4_tilde(h: float, u: float, beta: float) -> float:
    """As printed, but for the third condition, which lacks its number (a2 >= .); read with 1 it is right."""
    a2 = -u / sqrt(2 * beta * h)
    if a2 <= -1:
        return 0.0
    if a2 >= 1:
        return h * u**2 + beta * h**2 / 2
    return (
        4 / pi * beta * h**2 * (pi / 16 + asin(a2) / 8 - sin(4 * asin(a2)) / 32)
        - 4 / (3 * pi) * sqrt(2 * beta) * sqrt(h) ** 3 * u * cos(asin(a2)) ** 3
        + 2 / pi * h * u**2 * (pi / 4 + asin(a2) / 2 + sin(2 * asin(a2)) / 4)
    )


def fan_velocity(ray: float, h_left: float, u_left: float, beta: float, *, sign_mended: bool = False) -> float:
    """u in the fan of section 4 at (x - x0)/t = `ray`, printed with - u_left/2."""
    return 2 / 3 * (ray + sqrt(beta * h_left) + (0.5 if sign_mended else -0.5) * u_left)


def fan_height(ray: float, h_left: float, u_left: float, beta: float) -> float:
    """h in the fan of section 4; as printed; right."""
    return (u_left + 2 * sqrt(beta * h_left) - ray) ** 2 / (9 * beta)
