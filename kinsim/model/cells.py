"""The cells of the x-axis."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from ..memory import require
from ..value import Number, Whole, value

TINY = float(np.finfo(float).tiny)
"""The smallest normal number; below it digits get lost."""

BYTES = 400
"""That a cell takes in a run: about fifty numbers."""


@value
class Cells:
    """`count` equal cells C_i = [x_{i-1/2}, x_{i+1/2}] between `left` and `right` (dimensionless lengths)."""

    left: Number
    right: Number
    count: Annotated[Whole, Field(ge=2)]

    def __post_init__(self) -> None:
        if not self.left < self.right:
            raise ValueError(f"left = {self.left:g} is not below right = {self.right:g}; exchange or change them")
        if not TINY <= self.dx < float("inf"):
            raise ValueError(
                f"{self.count} cells from {self.left:g} to {self.right:g} are {self.dx:g} long; change them"
            )
        require(float(self.count) * BYTES, f"{self.count} cells")

    @property
    def dx(self) -> float:
        """Length of a cell."""
        return (self.right - self.left) / self.count

    @property
    def x(self) -> NDArray[np.float64]:
        """Cell centres, shape (count,); mirrored ends give bitwise mirrored centres."""
        i = np.arange(self.count) + 0.5
        return self.left * ((self.count - i) / self.count) + self.right * (i / self.count)

    @property
    def faces(self) -> NDArray[np.float64]:
        """Faces between and beside the cells, shape (count + 1,)."""
        i = np.arange(self.count + 1.0)
        return self.left * ((self.count - i) / self.count) + self.right * (i / self.count)
