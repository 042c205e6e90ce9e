"""The two ends of the domain: what a ghost cell holds."""

from __future__ import annotations

from typing import Annotated, Any, Literal

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
