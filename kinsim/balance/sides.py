"""Both sides of xi = 0 from the one that holds less of M: the other is the total (3) less it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel_inner, kernel_part
from ..local import Local, Sides, at, left, right

Array = NDArray[np.float64]

TINY = float(np.finfo(float).tiny)
"""Keeps a division by c defined on dry ground, where its weight is zero."""


@kernel_part
def ahead(h: float, u: float, beta: float, m1: float, m2: float) -> tuple[float, float]:
    """Moments of xi M and xi^2 M over xi > 0; m1, m2 >= 0 are those of the smaller side, mirrored."""
    h = max(h, 0.0)
    total1 = h * u
    total2 = h * u * u + 0.5 * beta * h * h
    first = total1 + m1 if u > 0.0 else m1
    second = total2 - m2 if u > 0.0 else (m2 if u < 0.0 else 0.5 * total2)
    return first, second


@kernel_part
def both_sides(h: float, u: float, beta: float, m1: float, m2: float) -> tuple[float, float, float, float]:
    """Moments of xi M and xi^2 M over xi >= 0, then over xi < 0.

    Mirrored states give bitwise mirrored moments, and both sides add up to the totals.
    """
    p1, p2 = ahead(h, u, beta, m1, m2)
    n1, n2 = ahead(h, -u, beta, m1, m2)
    return p1, p2, -n1, n2


@kernel_part
def between(
    h_left: float, u_left: float, beta_left: float, m1_left: float, m2_left: float,
    h_right: float, u_right: float, beta_right: float, m1_right: float, m2_right: float,
) -> tuple[float, float]:  # fmt: skip
    """F of (24) at one face: xi > 0 from the left and xi < 0 from the right."""
    p1, p2 = ahead(h_left, u_left, beta_left, m1_left, m2_left)
    n1, n2 = ahead(h_right, -u_right, beta_right, m1_right, m2_right)
    return p1 - n1, p2 + n2


@kernel_inner
def faces_of_cells(h: Array, u: Array, beta: Local, m1: Array, m2: Array, F1: Array, F2: Array) -> None:
    """F of (24): xi > 0 from the cell left of a face and xi < 0 from the one right of it; h, u, m are ghosted."""
    for i in range(F1.size):
        here, after = (
            (h[i], u[i], at(beta, i), m1[i], m2[i]),
            (h[i + 1], u[i + 1], at(beta, i + 1), m1[i + 1], m2[i + 1]),
        )
        F1[i], F2[i] = between(*here, *after)


@kernel_inner
def faces_of_states(
    h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides, m: Array, F1: Array, F2: Array
) -> None:
    """The same for faces with states of their own; the rows of `m` are the moments of the left and right states."""
    for i in range(F1.size):
        here = (h_left[i], u_left[i], at(left(beta), i), m[0, i], m[1, i])
        F1[i], F2[i] = between(*here, h_right[i], u_right[i], at(right(beta), i), m[2, i], m[3, i])
