"""The bed as kernels see it: numbers for a constant slope, arrays for a smooth chute; and the law of friction on it.

Arrays have two ghosts at each end; what belongs to the face between the cells i and i + 1 stands at i. At such a face
the pressure of (13) has the slope

    D = (beta_f (h_{i+1} - h_i) + (beta_{i+1} - beta_i) (h_i + h_{i+1})/4)/dx,   beta_f = (beta_i + beta_{i+1})/2,

of second order for beta h_x + beta' h/2; so that what friction balances, |sin zeta - D| <= R, is a jump of heights
between (+-R + sin zeta) dx/beta_f - tilt (h_i + h_{i+1}) with tilt = (beta_{i+1} - beta_i)/(4 beta_f).

Resting cells send the same mass to both sides of their face where h_i = r h_{i+1}, r = (beta_{i+1}/beta_i)^(1/3), for a
half of M carries (2 beta h)^(3/2)/(3 pi beta).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from ..arrays import Array
from ..compiled import short_question

LEAST = 1e-100
"""Laws of friction are never asked about lower heights, whose squares would underflow."""


class Plane(NamedTuple):
    """A constant slope: sin zeta, cos zeta and beta."""

    s: float
    n: float
    beta: float


class Curve(NamedTuple):
    """A smooth chute: sin zeta, cos zeta, eta kappa and beta of cells, then of faces, and r - 1, 1/r - 1 of faces."""

    s: Array
    n: Array
    bend: Array
    beta: Array
    s_face: Array
    n_face: Array
    beta_face: Array
    tilt: Array
    uneven_left: Array
    uneven_right: Array

    def pull(bed, i):
        return bed.s[i]

    def beta_of(bed, i):
        return bed.beta[i]

    def normal(bed, i, u, grip_dt):
        a = grip_dt * max(bed.bend[i], 0.0) * abs(u)
        share = (1.0 - 0.81 / (a + 0.8)) / a if a > 0.1 else 1.0
        return max(bed.n[i] + bed.bend[i] * u * u * share, 0.0)

    def face(bed, i):
        return bed.s_face[i], bed.n_face[i], bed.beta_face[i], bed.tilt[i]

    def uneven(bed, i):
        return bed.uneven_left[i], bed.uneven_right[i]

    def beta_jump(bed, i):
        return bed.beta_face[i] - bed.beta_face[i - 1]


@short_question
def pull(bed: Any, i: int) -> float:
    """sin zeta of cell i."""
    return bed.s


@short_question
def beta_of(bed: Any, i: int) -> float:
    """beta of cell i."""
    return bed.beta


@short_question
def normal(bed: Any, i: int, u: float, grip_dt: float) -> float:
    """The normal acceleration cos zeta + eta kappa u^2 of cell i, 0 where it would be negative.

    Where the bend presses, friction takes the share a = dt tan(delta) eta kappa |u| of the momentum, `grip_dt` being
    dt tan(delta). Where a > 1/10 it leaves 0.81/(a + 0.8) of it, which goes on from 1 - a without a kink and is near
    the 1/(1 + a) of u' = -tan(delta) eta kappa u^2 at any a.
    """
    return bed.n


@short_question
def face(bed: Any, i: int) -> tuple[float, float, float, float]:
    """sin zeta, cos zeta, beta and tilt of the face between the cells i and i + 1."""
    return bed.s, bed.n, bed.beta, 0.0


@short_question
def uneven(bed: Any, i: int) -> tuple[float, float]:
    """r - 1 and 1/r - 1 of the face between the cells i and i + 1."""
    return 0.0, 0.0


@short_question
def beta_jump(bed: Any, i: int) -> float:
    """What beta grows by from the left to the right face of cell i."""
    return 0.0
