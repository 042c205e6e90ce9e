"""Velocity space: where the density lives."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from ..errors import InputError
from ..value import Number, Whole, kind, value

Beyond = Literal["stop", "warn"]

FASTEST = 1e100
"""Velocities beyond are refused: third moments have to be numbers, and so have sums of them."""

WIDEST = 1e5
"""Velocity cells on one side beyond which a window is refused: a step would take a second for every hundred cells."""


@value
class Uniform:
    """`count` equal velocity cells between -bound and bound, an edge at xi = 0, shared by all cells of the x-axis.

    Attributes:
        count: Velocity cells, even.
        bound: Outer edge; None takes 1.05 times the largest |u| + c + dt |g| of a run of the closed-form twin.
        beyond: When velocities leave the window: "stop" the run, or "warn", go on without them and book the loss.
    """

    count: Annotated[Whole, Field(ge=2)] = 128
    bound: Annotated[Number, Field(gt=0)] | None = None
    beyond: Beyond = "stop"
    kind: Literal["uniform"] = kind("uniform")

    def __post_init__(self) -> None:
        if self.count % 2:
            raise ValueError(
                f"count = {self.count} is odd, and no velocity cell may straddle xi = 0; take {self.count + 1}"
            )

    @property
    def words(self) -> str:
        """In a few words."""
        return f"{self.count} nodes"

    follows: ClassVar[bool] = False

    def grid(self, reach: float, spare: int = 0) -> Grid:
        """The same grid for every reach."""
        if self.bound is None:
            raise ValueError("a velocity grid needs its bound; simulate finds one, or give it")
        return _within_numbers(Grid(self.count, 2.0 * self.bound / self.count))


@value
class Window:
    """Velocity cells of width `dxi` that follow the occupied velocities |xi| <= max(|u| + c); cost follows the support.

    Attributes:
        dxi: Width of a velocity cell.
        margin: The window reaches to `margin` times the occupied velocities when it is made anew, as they leave it.
    """

    dxi: Annotated[Number, Field(gt=0)]
    margin: Annotated[Number, Field(ge=1)] = 1.1
    kind: Literal["window"] = kind("window")

    @property
    def words(self) -> str:
        """In a few words."""
        return f"window of cells {self.dxi:g}"

    follows: ClassVar[bool] = True
    beyond: ClassVar[Beyond] = "stop"

    def grid(self, reach: float, spare: int = 0) -> Grid:
        """A window around velocities up to `reach`, and so many cells beyond."""
        half = max(self.margin * (reach / self.dxi + spare), 2.0)
        if not half <= WIDEST:
            raise InputError(
                f"velocity: a window of {2 * half:.3g} cells is asked for; take dxi well above {self.dxi:g}"
            )
        return _within_numbers(Grid(2 * math.ceil(half), self.dxi))


@value
class Fitted:
    """`count` Gauss-Jacobi nodes per cell on the side of xi = 0 that holds less of M: `kinsim.kinetic.gauss_jacobi`."""

    count: Annotated[Whole, Field(ge=1, le=64)] = 6
    kind: Literal["fitted"] = kind("fitted")

    @property
    def words(self) -> str:
        """In a few words."""
        return f"{self.count} fitted nodes"


Velocity = Annotated[Uniform | Window | Fitted, Field(discriminator="kind")]


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
        centres: NDArray[np.float64] = (np.arange(self.half, dtype=float) + 0.5) * self.dxi
        return centres

    @property
    def xi(self) -> NDArray[np.float64]:
        """Centres, ascending, shape (count,)."""
        return np.concatenate([-self.side[::-1], self.side])

    @property
    def edges(self) -> NDArray[np.float64]:
        """Edges of the cells, ascending, shape (count + 1,)."""
        edges: NDArray[np.float64] = np.arange(-self.half, self.half + 1, dtype=float) * self.dxi
        return edges


def _within_numbers(grid: Grid) -> Grid:
    """`grid`, if sums over it cannot overflow."""
    if not grid.bound <= FASTEST:
        asked = f"a window up to {grid.bound:.3g} is asked for, at most {FASTEST:g} can be had"
        raise InputError(f"velocity: {asked}; take shorter steps or smaller velocities")
    return grid
