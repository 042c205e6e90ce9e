"""Initial masses: each heap gives the height h and the velocity u at the places x."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    BeforeValidator,
    Field,
    GetPydanticSchema,
    ValidatorFunctionWrapHandler,
    WrapSerializer,
    WrapValidator,
)
from pydantic_core import core_schema

from ..arrays import Array
from ..errors import InputError
from ..expression import check_names, evaluate
from ..value import Number, described_outside, kind, value
from .csv_table import read_columns

State = tuple[Array, Array]


@value
class Blocks:
    """Heights that jump at `edges`: heights[k] between edges[k-1] and edges[k], the upper edge included.

    `velocities`, one for each height, are 0 if not given.
    """

    edges: tuple[Number, ...]
    heights: tuple[Number, ...]
    velocities: tuple[Number, ...] | None = None
    kind: Literal["blocks"] = kind("blocks")

    def __post_init__(self) -> None:
        if len(self.heights) != len(self.edges) + 1:
            raise ValueError(f"{len(self.edges)} edges need {len(self.edges) + 1} heights, got {len(self.heights)}")
        if len(self.speeds) != len(self.heights):
            raise ValueError(f"{len(self.heights)} heights need as many velocities, got {len(self.speeds)}")
        if any(a >= b for a, b in zip(self.edges, self.edges[1:], strict=False)):
            raise ValueError("edges must increase; sort them")

    def __call__(self, x: Array) -> State:
        """h, u at `x`."""
        block = np.searchsorted(self.edges, x, side="left")
        return np.asarray(self.heights)[block], np.asarray(self.speeds)[block]

    @property
    def speeds(self) -> tuple[float, ...]:
        """The velocity of each block."""
        return (0.0,) * len(self.heights) if self.velocities is None else self.velocities


@value
class Parabola:
    """The cap max(peak/10, peak - steepness (x - centre)^2): the paper's fourth example, K = peak and l = steepness.

    All of it has the same `velocity`.
    """

    peak: Number = 1.0
    steepness: Number = 4.0
    centre: Number = 0.0
    velocity: Number = 0.0
    kind: Literal["parabola"] = kind("parabola")

    def __call__(self, x: Array) -> State:
        """h, u at `x`."""
        h = np.maximum(self.peak / 10, self.peak - self.steepness * (x - self.centre) ** 2)
        return h, np.full_like(x, self.velocity)


@value
class Sine:
    """The paper's fifth example: max(0.9 sin(pi y) - 0.3 sin(2 pi y), 0.1) for 0 < y = x - start < 1, else 0.1.

    All of it has the same `velocity`.
    """

    start: Number = 0.6
    velocity: Number = 0.0
    kind: Literal["sine"] = kind("sine")

    def __call__(self, x: Array) -> State:
        """h, u at `x`."""
        y = x - self.start
        hump = np.maximum(0.9 * np.sin(np.pi * y) - 0.3 * np.sin(2 * np.pi * y), 0.1)
        return np.where((y > 0) & (y < 1), hump, 0.1), np.full_like(x, self.velocity)


@value
class Expression:
    """Formulas in x, for example ``h = "max(0, 1 - x**2)"`` (see `kinsim.expression`)."""

    h: str
    u: str = "0"
    kind: Literal["expression"] = kind("expression")

    def __post_init__(self) -> None:
        check_names(self.h)
        check_names(self.u)

    def __call__(self, x: Array) -> State:
        """h, u at `x`."""
        return evaluate(self.h, x), evaluate(self.u, x)


@value
class Table:
    """A CSV file with the columns x, h and, if wanted, u; linear between its rows, constant beyond its ends."""

    path: Annotated[Path, BeforeValidator(lambda given: Path(given) if isinstance(given, str) else given)]
    kind: Literal["table"] = kind("table")

    def __post_init__(self) -> None:
        self._columns()

    def __call__(self, x: Array) -> State:
        """h, u at `x`."""
        places, h, u = self._columns()
        return np.interp(x, places, h), np.interp(x, places, u)

    def _columns(self) -> tuple[Array, Array, Array]:
        columns = read_columns(self.path, (("x", "h"), ("x", "h", "u")))
        return columns["x"], columns["h"], columns.get("u", np.zeros(columns["x"].size))


def _cell_values(given: Any) -> Array:
    try:
        array = np.array(given, dtype=float)
    except (TypeError, ValueError):
        raise ValueError("must be a list of numbers, one per cell") from None
    if array.ndim != 1 or not np.isfinite(array).all():
        raise ValueError("must be a list of finite numbers, one per cell")
    array.flags.writeable = False
    return array


CellValues = Annotated[
    Array,
    GetPydanticSchema(
        lambda source, handler: core_schema.no_info_plain_validator_function(
            _cell_values, serialization=core_schema.plain_serializer_function_ser_schema(lambda array: array.tolist())
        ),
        lambda schema, handler: {"type": "array", "items": {"type": "number"}},
    ),
]


@value
class Profile:
    """Cell values as they are, `h` and `u` of shape (cells.count,); u = 0 if not given."""

    h: CellValues
    u: CellValues | None = None
    kind: Literal["profile"] = kind("profile")

    def __call__(self, x: Array) -> State:
        """h, u at `x`."""
        u = np.zeros_like(self.h) if self.u is None else self.u
        of_u = "" if self.u is None else f" and u {u.size}"
        if self.h.shape != x.shape or u.shape != x.shape:
            raise InputError(f"profile: h has {self.h.size} values{of_u} for {x.size} cells; give one per cell")
        return self.h.copy(), u.copy()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Profile):
            return NotImplemented
        mine, theirs = (np.zeros_like(p.h) if p.u is None else p.u for p in (self, other))
        return np.array_equal(self.h, other.h) and np.array_equal(mine, theirs)

    def __hash__(self) -> int:
        return hash(self.h.tobytes())

    def __repr__(self) -> str:
        moving = "" if self.u is None else f", u={_outline(self.u)}"
        return f"Profile(h={_outline(self.h)}{moving})"


def _outline(array: Array) -> str:
    if array.size <= 8:
        return repr(array.tolist())
    low, high = (f"{bound:.6g}" for bound in (math.fsum([array.min()]), math.fsum([array.max()])))
    return f"<{array.size} values, {low} to {high}>"


KINDS = (Blocks, Parabola, Sine, Table, Expression, Profile)


def _from_outside(given: Any, check: ValidatorFunctionWrapHandler) -> Any:
    """A heap of the package is checked; a function of one's own, x -> (h, u), is taken as it is."""
    return given if callable(given) and type(given) not in KINDS else check(given)


Heap = Annotated[
    Annotated[Blocks | Parabola | Sine | Table | Expression | Profile, Field(discriminator="kind")],
    WrapValidator(_from_outside),
    WrapSerializer(described_outside),
]
