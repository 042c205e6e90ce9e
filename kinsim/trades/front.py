"""What is worth its cost: the Pareto front, and its knee."""

from __future__ import annotations

import numpy as np

from ..arrays import Array

APART = 0.01
"""By so much less an error has to be to count as less."""


def pareto(cost: Array, error: Array) -> list[int]:
    """Members that are nearer, by more than `APART`, than all that are as fast, by rising cost; NaN never counts."""
    best, front = np.inf, []
    for at in np.lexsort((error, cost)):
        if np.isfinite(cost[at]) and error[at] < (1.0 - APART) * best:
            best = error[at]
            front.append(int(at))
    return front


def knee(cost: Array, error: Array, front: list[int]) -> int | None:
    """The member of the front that lies farthest below the chord from its first to its last, in logarithms."""
    if len(front) < 3 or min(error[front]) <= 0.0:
        return None
    x, y = np.log(cost[front]), np.log(error[front])
    chord = y[0] + (y[-1] - y[0]) * (x - x[0]) / (x[-1] - x[0])
    at = int(np.argmax(chord - y))
    return front[at] if 0 < at < len(front) - 1 else None
