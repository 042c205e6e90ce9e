"""Measured chutes: angles or elevations at some places, smoothed by a spline."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from ..arrays import Array
from ..errors import InputError
from ..value import Number, kind, value
from .csv_table import read_columns

if TYPE_CHECKING:
    from scipy.interpolate import UnivariateSpline

Smoothing = Annotated[Number, Field(ge=0, le=1000)]

BETWEEN = 20
"""Places between two points at which the length of a measured chute is summed up."""


@value
class SlopePoints:
    """A smoothing spline of fifth degree through measured points; a straight slope beyond the first and the last one.

    Attributes:
        x: Places that increase, six or more: along the chute for angles, horizontal for elevations.
        zeta: Angles there in radians; or
        elevation: elevations there, in the same unit as x. The chute then begins at the first x, and is as long as it
            is along the ground.
        smoothing: The root of the mean square by which the spline may miss the points; 0 goes through them all.
    """

    x: tuple[Number, ...]
    zeta: tuple[Number, ...] | None = None
    elevation: tuple[Number, ...] | None = None
    smoothing: Smoothing = 0.0
    kind: Literal["points"] = kind("points")

    def __post_init__(self) -> None:
        if (self.zeta is None) == (self.elevation is None):
            raise ValueError("zeta or elevation; give one of the two")
        if len(self.x) < 6 or len(self.x) != len(self._given):
            raise ValueError(f"{len(self.x)} places and {len(self._given)} values; give six or more of each, in pairs")
        if any(a >= b for a, b in zip(self.x, self.x[1:], strict=False)):
            raise ValueError("x must increase; sort the points")

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """zeta and its derivative at the places `x` along the chute."""
        spline = self._spline()
        end, across = self._along(spline)
        inside = (x >= self.x[0]) & (x <= end)
        place = across(np.clip(x, self.x[0], end))
        if self.elevation is None:
            return spline(place), np.where(inside, spline(place, nu=1), 0.0)
        steepness = spline(place, nu=1)
        return -np.arctan(steepness), np.where(inside, -spline(place, nu=2) / (1.0 + steepness**2) ** 1.5, 0.0)

    @property
    def _given(self) -> tuple[float, ...]:
        return self.zeta if self.zeta is not None else self.elevation or ()

    def _spline(self) -> UnivariateSpline:
        from scipy.interpolate import UnivariateSpline

        try:
            return UnivariateSpline(self.x, self._given, k=5, s=len(self.x) * self.smoothing**2)
        except ValueError as error:
            raise InputError(f"chute: no spline goes through these points: {error}; spread them more evenly") from None

    def _along(self, spline: UnivariateSpline) -> tuple[float, Callable[[Array], Array]]:
        """Where the points end along the chute, and how the x of the points follows from a place along it."""
        if self.elevation is None:
            return self.x[-1], lambda place: place
        from scipy.interpolate import InterpolatedUnivariateSpline

        knots = np.asarray(self.x)
        shares = np.arange(BETWEEN) / BETWEEN
        across = np.append((knots[:-1, None] + np.diff(knots)[:, None] * shares).ravel(), knots[-1])
        length = InterpolatedUnivariateSpline(across, np.hypot(1.0, spline(across, nu=1)), k=5).antiderivative()
        along = self.x[0] + length(across) - length(across[0])
        return float(along[-1]), InterpolatedUnivariateSpline(along, across, k=5)


@value
class SlopeTable:
    """The same from a CSV file with the columns x, zeta (along the chute) or x, elevation (horizontal, vertical)."""

    path: Annotated[Path, BeforeValidator(lambda given: Path(given) if isinstance(given, str) else given)]
    smoothing: Smoothing = 0.0
    kind: Literal["table"] = kind("table")

    def __post_init__(self) -> None:
        self.points()

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """zeta and its derivative at the places `x` along the chute."""
        return self.points()(x)

    def points(self) -> SlopePoints:
        """What the file holds, as a value of its own."""
        columns = read_columns(self.path, (("x", "zeta"), ("x", "elevation")))
        given = {name: tuple(column.tolist()) for name, column in columns.items()}
        return SlopePoints(given["x"], given.get("zeta"), given.get("elevation"), self.smoothing)
