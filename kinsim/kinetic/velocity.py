"""Velocity space: where the density lives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from ..value import Number, Whole, kind, value


@value
class Uniform:
    """`count` equal velocity cells between -bound and bound, an edge at xi = 0, shared by all cells of the x-axis.

    Without a `bound` a run takes 1.05 times the largest |u| + c + dt |g| of a run of the closed-form twin.
    """

    count: Annotated[Whole, Field(ge=2)] = 128
    bound: Annotated[Number, Field(gt=0)] | None = None
    kind: Literal["uniform"] = kind("uniform")

    def __post_init__(self) -> None:
        if self.count % 2:
            raise ValueError(
                f"count = {self.count} is odd, and no velocity cell may straddle xi = 0; take {self.count + 1}"
            )

    def grid(self) -> Grid:
        """The grid itself; needs a bound."""
        if self.bound is None:
            raise ValueError("a velocity grid needs its bound; simulate finds one, or give it")
        return Grid(self.count, 2.0 * self.bound / self.count)


@dataclass(frozen=True)
class Grid:
    """`count` velocity cells of width `dxi`, symmetric about xi = 0."""

    count: int
    dxi: float

    @property
    def half(self) -> int:
        """Cells on each side of xi = 0."""
        return self.count // 2

    @property
    def bound(self) -> float:
        """Outer edge."""
        return self.half * self.dxi

    @property
    def side(self) -> NDArray[np.float64]:
        """Centres of the cells with xi > 0, outward, shape (count/2,)."""
        return (np.arange(self.half, dtype=float) + 0.5) * self.dxi

    @property
    def xi(self) -> NDArray[np.float64]:
        """Centres, ascending, shape (count,)."""
        return np.concatenate([-self.side[::-1], self.side])
