"""The equilibrium of section 2.2 in rho = beta h and m = beta h u, (15) and (16); all numbers are dimensionless."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array

Numbers = float | Array


def chi(w: Numbers) -> Array:
    """chi(w) = sqrt((2 - w^2)_+) / pi, the semicircle that meets (16): mass 1, mean 0, variance 1/2."""
    square: Array = np.maximum(2.0 - np.square(w), 0.0)
    return np.sqrt(square) / math.pi


def equilibrium(xi: Numbers, rho: Numbers, u: Numbers) -> Array:
    """M(rho, xi - u) = sqrt(rho) chi((xi - u)/sqrt(rho)), (15), which is beta times M of (12) with that beta.

    Args:
        xi: Velocities; the three arguments are broadcast.
        rho: beta h, at least 0.
        u: m / rho.
    """
    square: Array = np.maximum(2.0 * np.asarray(rho) - np.square(np.subtract(xi, u)), 0.0)
    return np.sqrt(square) / math.pi
