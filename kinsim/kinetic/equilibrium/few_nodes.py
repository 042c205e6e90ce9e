"""Densities on two or four nodes: what is left where the support of M is thinner than the grid."""

from __future__ import annotations

import math

from ...arrays import Array
from ...compiled import routine
from .status import MASS_ONLY, TWO_MOMENTS, TWO_NODES


@routine()
def add_pair(mass: float, u: float, low: int, high: int, dxi: float, P: Array, N: Array) -> None:
    """Add `mass` with mean u on the nodes `low` and `high`; node j stands at (j + 1/2) dxi, those below 0 in N."""
    share = (u / dxi - (low + 0.5)) / (high - low)
    for j, part in ((low, 1.0 - share), (high, share)):
        if j >= 0:
            P[j] += mass * part / dxi
        else:
            N[-1 - j] += mass * part / dxi


@routine()
def few_nodes(h: float, u: float, beta: float, dxi: float, want_three: bool, P: Array, N: Array) -> int:
    """Carry mass h, momentum h u and, if it can be and is wanted, h u^2 + beta h^2/2 on two to four nodes, all >= 0.

    Two neighbours of u have the least variance that mass and momentum allow; mixed with a wider pair they reach any
    larger one. u >= 0. Returns the kind of fall-back.
    """
    half = P.size
    P[:] = 0.0
    N[:] = 0.0
    place = min(u / dxi - 0.5, float(half))
    low = math.floor(place)
    if low + 1 >= half:
        P[half - 1] = h / dxi
        return MASS_ONLY
    high = low + 1
    target = 0.5 * beta * h
    least = (u - (low + 0.5) * dxi) * ((high + 0.5) * dxi - u)
    if not want_three or target < least:
        add_pair(h, u, low, high, dxi, P, N)
        return TWO_MOMENTS
    wide_low, wide_high, wide = low, high, least
    while wide < target:
        down, up = u - (wide_low + 0.5) * dxi, (wide_high + 0.5) * dxi - u
        if down == up:
            wide_low -= 1
            wide_high += 1
        elif down < up:
            wide_low -= 1
        else:
            wide_high += 1
        if wide_high >= half or wide_low < -half:
            add_pair(h, u, low, high, dxi, P, N)
            return TWO_MOMENTS
        wide = (u - (wide_low + 0.5) * dxi) * ((wide_high + 0.5) * dxi - u)
    share = (target - least) / (wide - least) if wide > least else 0.0
    add_pair(h * (1.0 - share), u, low, high, dxi, P, N)
    add_pair(h * share, u, wide_low, wide_high, dxi, P, N)
    return TWO_NODES
