"""What the ground has: one number for all of it, or a number per cell or face.

Kernels ask with `at`, `left` and `right`, so that each is written once; `kinsim.kernel` tells the compiler the answers.
For a number it leaves nothing of the question: code for constant slopes is what it would be without.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Local = float | Array
"""One number, or an array of them."""

Sides = Local | tuple[Array, Array]
"""The same, or arrays of the left and of the right side of faces."""


def at(value: Local, i: int) -> float:
    """The number that belongs to place i."""
    return float(value[i]) if isinstance(value, np.ndarray) else value


def left(value: Sides) -> Local:
    """What belongs to the left sides of faces."""
    return value[0] if isinstance(value, tuple) else value


def right(value: Sides) -> Local:
    """What belongs to the right sides of faces."""
    return value[1] if isinstance(value, tuple) else value


def varies(value: Local) -> bool:
    """Whether it is a number per place."""
    return isinstance(value, np.ndarray)
