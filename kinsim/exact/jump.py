"""A shock between two heights, by Rankine and Hugoniot; roots apart, so that no product leaves floating point."""

from __future__ import annotations

import math


def difference(h: float, k: float, beta: float) -> float:
    """By how much the velocity falls across it, |h - k| sqrt(beta (1/h + 1/k)/2)."""
    return _root(h, k, beta) * (abs(h - k) / math.sqrt(h) / math.sqrt(k))


def speed(high: float, low: float, beta: float) -> float:
    """Its speed against the lower side, into which it runs, sqrt(beta high (high + low)/(2 low))."""
    return _root(high, low, beta) * (math.sqrt(high) / math.sqrt(low))


def _root(h: float, k: float, beta: float) -> float:
    """sqrt(beta (h + k)/2)."""
    return math.sqrt(beta) * math.sqrt(0.5 * h + 0.5 * k)
