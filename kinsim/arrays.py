"""The kinds of arrays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Flags = NDArray[np.bool_]

Local = float | Array
"""One number, or an array of them."""
