"""The impulse of scheme 4: one clamped shift per cell does what gravity, friction, stopping and holding do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..kernel import kernel, kernel_part
from ..local import Local, at, varies
from .impulse import DRY

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

SHY = 1.0 - 1e-13
"""Keeps the pull at rest below what it balances, rounding of heights a thousand jumps high included."""


@kernel_part
def nothing(h: float) -> float:
    """0, but of a number that is none, which has to stay one."""
    return 0.0 + 0.0 * h


@kernel
def below_nothing(h1: Array) -> float:
    """How far heights lie below 0 in sum: what cutting them at 0 will make."""
    any_does = False
    for i in range(h1.size):
        any_does |= h1[i] < 0.0
    made = 0.0
    for i in range(h1.size if any_does else 0):
        made -= min(h1[i], 0.0)
    return made


@kernel
def within(h: Array, h1: Array, pulled: Array) -> None:
    """h, but at least half and at most twice h1; all of shape (nx,)."""
    for i in range(h.size):
        pulled[i] = min(max(h[i], 0.5 * h1[i]), 2.0 * h1[i])


@kernel
def clip_velocity(low: Array, high: Array, h1: Array, qhat: Array) -> None:
    """Keep qhat/h^{n+1} among the particles that could come: those of the cells i - 1, i and i + 1.

    `low` and `high` are the slowest and the fastest particle of each ghosted cell, inf and -inf where it is dry. In
    exact arithmetic nothing changes; it is the whole rule for dry ground.
    """
    for i in range(h1.size):
        v = qhat[i] / h1[i]
        slowest = min(low[i + 1], min(low[i], low[i + 2]))
        quickest = max(high[i + 1], max(high[i], high[i + 2]))
        among = qhat[i] if v >= slowest else slowest * h1[i]
        among = quickest * h1[i] if v > quickest else among
        among = qhat[i] if slowest > quickest else among  # a film between nodes: no particle is seen, and none came
        qhat[i] = 0.0 if h1[i] < DRY else among
        h1[i] = nothing(h1[i]) if h1[i] < DRY else h1[i]


@kernel
def uphill_pull(h: float, above: float, below: float, net: float, reach: float, theta: float) -> float:
    """The least pull s - R > 0 (`net`) on a cell of a mass that leans downhill, as the faces of a resting one see it.

    The faces of the cell show the lower heights, so that the pressure between them is that of the mean of h and `above`
    (its neighbour uphill), less than that of h; the pull is lessened alike, as far as theta holds. At a toe lower
    than the jump `reach` = (s - R) dx/beta that friction balances, all of the pressure of h is at hand, and that of its
    neighbour `below`; where it moves it is let go slower than the faces give pressure back, with (1 - theta)^2.
    """
    if not (h > 0.0 and theta > 0.0):
        return net
    share = 1.0 - theta * max(h - above, 0.0) / (2.0 * h)
    if h < reach:
        least = min(above, h)
        at_hand = 0.5 * max(h * h - least * least, 0.0) / (h * reach) + max(1.0 - (below - h) / reach, 0.0)
        share = min(share, 1.0 - (1.0 - at_hand) * theta * (2.0 - theta))
    return net * share * SHY


@kernel
def clamped(
    h: Array, h1: Array, qhat: Array, pulled: Array, e: Array, theta: Array, still: Flags,
    s: Local, R: Local, beta: Local, dx: float, dt: float, wall_left: bool, wall_right: bool, J: Array,
) -> None:  # fmt: skip
    """J = clamp(-qhat; dt (s - R) pulled, dt (s + R) pulled): friction stops, and never reverses.

    h is ghosted; `pulled` is the height that the force acts on. A cell between two still faces is held. Where even a
    resting mass is driven (|s| > R), the bound that drives it is that of `uphill_pull`; a wall bears what stands before
    it as a heap of the same slope would.
    """
    last = J.size - 1
    driven = varies(s) or at(s, 0) - at(R, 0) > 0.0 or at(s, 0) + at(R, 0) < 0.0
    for i in range(J.size if driven else 0):
        before, here, after = h[i], h[i + 1], h[i + 2]
        if wall_left and i == 0:
            before = max(here - e[0], 0.0)
        if wall_right and i == last:
            after = max(here + e[last + 1], 0.0)
        pull, friction, by = at(s, i), at(R, i), at(beta, i)
        low, high = pull - friction, pull + friction
        held = min(theta[i], theta[i + 1])
        if low > 0.0:
            low = uphill_pull(here, before, after, low, low * dx / by, held)
        elif high < 0.0:
            high = -uphill_pull(here, after, before, -high, -high * dx / by, held)
        J[i] = min(max(-qhat[i], (dt * low) * pulled[i]), (dt * high) * pulled[i])
    low, high = dt * (at(s, 0) - at(R, 0)), dt * (at(s, 0) + at(R, 0))
    for i in range(0 if driven else J.size):
        J[i] = min(max(-qhat[i], low * pulled[i]), high * pulled[i])
    for i in range(J.size):
        J[i] = -qhat[i] if still[i] & still[i + 1] else J[i]
