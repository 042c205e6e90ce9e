"""What (1) leaves over when a formula is put into it, in 40 digits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath as mp

Formula = Callable[[Any, Any], tuple[Any, Any]]


def residual(formula: Formula, beta: float, m: float, x: float, t: float) -> float:
    """Larger residual of h_t + q_x = 0 and q_t + (q^2/h + beta h^2/2)_x = m h at (x, t).

    `formula` maps mpmath numbers x, t to h, u. Differences of mpmath in 40 digits are good to about 1e-20.
    """

    def derivative(of: Callable[[Any, Any], Any], order: tuple[int, int]) -> Any:
        return mp.diff(of, (mp.mpf(x), mp.mpf(t)), order)

    def flux(h: Any, u: Any) -> Any:
        return h * u * u + beta * h * h / 2

    with mp.workdps(40):
        mass = derivative(lambda x, t: formula(x, t)[0], (0, 1)) + derivative(
            lambda x, t: mp.fprod(formula(x, t)), (1, 0)
        )
        momentum = derivative(lambda x, t: mp.fprod(formula(x, t)), (0, 1)) + derivative(
            lambda x, t: flux(*formula(x, t)), (1, 0)
        )
        return float(max(abs(mass), abs(momentum - m * formula(mp.mpf(x), mp.mpf(t))[0])))
