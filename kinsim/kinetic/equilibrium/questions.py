"""What is asked of an equilibrium M(h, xi - u), (12), on a velocity grid.

A density of one cell is two sides of xi = 0, each counted outward from there: entry k of a side, an array of shape
(n/2,), belongs to xi = (k + 1/2) dxi or to its mirror image. What is computed for |u| serves u < 0 with the sides
exchanged, so that mirrored states give bitwise mirrored densities.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...compiled import generic, question, routine, short_question


@question
def one_side(
    equilibrium: Any, h: float, u: float, beta: float, dxi: float, side: Array, other: Array
) -> tuple[int, int]:
    """M at the nodes xi > 0, and 0 where it has none; returns the first node and one past the last that it may reach.

    `other` is to work in.
    """
    both_sides(equilibrium, h, u, beta, dxi, side, other)
    return 0, side.size


@question
def both_sides(
    equilibrium: Any, h: float, u: float, beta: float, dxi: float, P: Array, N: Array
) -> tuple[int, float, int]:
    """M at the nodes xi > 0 and xi < 0; returns iterations, the residual, and what it fell back to."""
    one_side(equilibrium, h, u, beta, dxi, P, N)
    one_side(equilibrium, h, -u, beta, dxi, N, P)
    return 0, 0.0, 0


@short_question
def reports(equilibrium: Any) -> bool:
    """Whether it is solved for, so that there is something to report."""
    return False


@short_question
def wider(equilibrium: Any, dxi: float) -> float:
    """By how much its outermost node may lie beyond that of cell averages."""
    return 0.0


@short_question
def is_sampled(equilibrium: Any) -> bool:
    """Whether it stands on the nodes inside of the support, and not on the velocity cells that the support meets."""
    return False


@generic
def fill_rows(
    equilibrium: Any, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta_left: Array, beta_right: Array,
    dxi: float, rows: Array, iterations: NDArray[np.int64], residual: Array, fallback: NDArray[np.int64],
) -> None:  # fmt: skip
    """Rows of a density, shape (rows, n): for xi > 0 of the left states, for xi < 0 of the right ones.

    What the equilibrium reports is the worse of both.
    """
    half = rows.shape[1] // 2
    P, N, spare = np.zeros(half), np.zeros(half), np.zeros(half)
    for i in range(rows.shape[0]):
        tries, defect, fell = both_sides(equilibrium, h_left[i], u_left[i], beta_left[i], dxi, P, N)
        if h_right[i] != h_left[i] or u_right[i] != u_left[i] or beta_left[i] != beta_right[i]:
            more, rest, also = both_sides(equilibrium, h_right[i], u_right[i], beta_right[i], dxi, spare, N)
            tries, defect, fell = max(tries, more), max(defect, rest), max(fell, also)
        iterations[i], residual[i], fallback[i] = tries, defect, fell
        put(P, N, rows, i)


@routine()
def put(P: Array, N: Array, rows: Array, i: int) -> None:
    """Both sides as an ascending row."""
    half = P.size
    for k in range(half):
        rows[i, half + k] = P[k]
    for k in range(half):
        rows[i, half - 1 - k] = N[k]
