"""The two ends of the domain: what a ghost cell holds."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field

from ..value import Number, kind, value


@value
class Inflow:
    """A stream that stands before an end: height `h` and velocity `u`; with |u| > c in it, all of it comes in."""

    h: Annotated[Number, Field(ge=0)]
    u: Number
    kind: Literal["inflow"] = kind("inflow")


def _stream(given: Any) -> Any:
    return Inflow(**given) if isinstance(given, dict) else given


End = Annotated[Literal["open", "wall"] | Inflow, BeforeValidator(_stream)]
Boundary = Literal["open", "wall", "periodic"] | tuple[End, End]

EXPLAINED = {
    "open": "copies the outermost cell (zero gradient)",
    "wall": "mirrors the outermost cell, so that nothing passes",
    "periodic": "continues at the other end",
    "inflow": "a stream of given height and velocity, {h = 0.3, u = 2.0}",
}


def ends(boundary: Boundary) -> tuple[str | Inflow, str | Inflow]:
    """The kinds of the left and the right end."""
    return (boundary, boundary) if isinstance(boundary, str) else boundary


def streams(boundary: Boundary) -> list[Inflow]:
    """The ends at which a stream comes in."""
    return [end for end in ends(boundary) if isinstance(end, Inflow)]


def shown(boundary: Boundary, nx: int) -> tuple[int, int, bool, bool]:
    """Which of the `nx` inner cells the left and the right ghost show, and whether they show it mirrored."""
    left, right = ends(boundary)
    cells = (nx - 1 if left == "periodic" else 0), (0 if right == "periodic" else nx - 1)
    return *cells, left == "wall", right == "wall"


def extend(boundary: Boundary, h: NDArray[np.float64], u: NDArray[np.float64]) -> None:
    """Fill the ghost cells h[0], h[-1], u[0], u[-1] of arrays of shape (nx + 2,) in place."""
    left, right = ends(boundary)
    _fill(left, h, u, 0, 1, -2)
    _fill(right, h, u, -1, -2, 1)


def _fill(
    kind: str | Inflow, h: NDArray[np.float64], u: NDArray[np.float64], ghost: int, inner: int, across: int
) -> None:
    if isinstance(kind, Inflow):
        h[ghost], u[ghost] = kind.h, kind.u
        return
    source = across if kind == "periodic" else inner
    h[ghost] = h[source]
    u[ghost] = -u[source] if kind == "wall" else u[source]


def extend_flag(boundary: Boundary, flag: NDArray[np.bool_]) -> None:
    """Fill the ghosts of a cell property of shape (nx + 2,) that has no sign: a ghost counts as the cell it shows."""
    left, right = ends(boundary)
    flag[0] = flag[-2 if left == "periodic" else 1]
    flag[-1] = flag[1 if right == "periodic" else -2]


def extend_shown(
    boundary: Boundary,
    minus: tuple[NDArray[np.float64], NDArray[np.float64]],
    plus: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> None:
    """Let the ghost cells show what stands on the other side of their face; (h, u) pairs of shape (nx + 2,)."""
    left, right = ends(boundary)
    for end, at, to, across, beyond in ((left, 0, plus, minus, plus), (right, -1, minus, plus, minus)):
        inner, far = (1, -2) if at == 0 else (-2, 1)
        (h, u), (g, v), (k, w) = to, across, beyond
        if isinstance(end, Inflow):
            h[at], u[at] = end.h, end.u
            continue
        h[at] = k[far] if end == "periodic" else g[inner]
        u[at] = w[far] if end == "periodic" else (-v[inner] if end == "wall" else v[inner])
