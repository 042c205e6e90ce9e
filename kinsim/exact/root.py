"""Roots to the last digit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

HALVINGS = 10_000
"""More than it takes to halve the range of floating point down to a number of any size."""


def root_between(function: Callable[[float], float], low: float, high: float) -> float:
    """Where `function` changes its sign between `low` and `high`; `high` itself if rounding hides the change."""
    from scipy.optimize import brentq  # only where a root is looked for: half a second

    ends = function(low), function(high)
    if not min(ends) < 0.0 < max(ends):
        return high
    precise = {"xtol": np.finfo(float).tiny, "rtol": 4 * np.finfo(float).eps, "maxiter": HALVINGS}
    return float(brentq(function, low, high, **precise))
