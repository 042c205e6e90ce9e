"""The mean velocity that follows from mass and momentum."""

from __future__ import annotations

import numpy as np

from .arrays import Array


def mean_velocity(q: Array, h: Array) -> Array:
    """q/h, 0 on dry ground; arrays of one shape."""
    return np.divide(q, h, out=np.zeros_like(q), where=h > 0.0)
