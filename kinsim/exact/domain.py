"""What exact solutions share: their numbers, and the questions that they refuse."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import Field

from ..errors import InputError
from ..value import Number

Array = NDArray[np.float64]
NonNegative = Annotated[Number, Field(ge=0)]
Positive = Annotated[Number, Field(gt=0)]


def places(name: str, x: ArrayLike) -> Array:
    """`x` as an array of numbers.

    Raises:
        InputError: One is not a number.
    """
    array: Array = np.asarray(x, dtype=float)
    if np.isnan(array).any():
        raise InputError(f"{name}: an x is not a number; give places")
    return array


def moment(name: str, t: float, until: float = math.inf) -> float:
    """`t`, a time from the start to `until`, where the solution ends.

    Raises:
        InputError: It is none.
    """
    if not 0.0 <= t < math.inf:
        raise InputError(f"{name}: t = {t} is not a time at or after the start; take 0 <= t < infinity")
    if t > until:
        raise InputError(
            f"{name}: at t = {t:.6g} part of the mass has come to rest or turned; take 0 <= t <= {until!r}"
        )
    return t
