"""What a law of friction does in a step: the most it holds at faces, and what it brings to bear on a cell.

A law is r(h, v, n), the deceleration of a layer of height h that moves with the speed v >= 0 under the normal
acceleration n; r(h, 0, n) is the most that it holds at rest. `Scene.friction` gives the values that these questions
are asked of; see `kinsim.model.friction`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, NamedTuple

from ..compiled import short_question
from ..errors import InputError
from ..source import is_built_in, told
from .bed import LEAST

FORMULAS = ("resistance", "after", "brought", "brought_midway", "holds", "grip")
"""Methods of a law that kernels ask for; all but the first may be missing."""


@short_question
def resistance(law: Any, h: float, v: float, n: float) -> float:
    """r(h, v, n)."""
    return law.resistance(h, v, n)


@short_question
def grip(law: Any) -> float:
    """Friction over normal acceleration, tan delta of Coulomb's law."""
    return resistance(law, 1.0, 0.0, 1.0)


@short_question
def holds(law: Any, h: float, w: float, n: float) -> float:
    """R of a face: what holds there at rest and at the speed w of the face; h is that of its higher side."""
    high = max(h, LEAST)
    return min(resistance(law, high, 0.0, n), resistance(law, high, w, n))


@short_question
def after(law: Any, h: float, w: float, dt: float, n: float) -> float:
    """The speed v that is left of w after dt: the root of v + dt r(h, v, n) = w, 0 if friction stops it (Illinois)."""
    low, high = 0.0, w
    f_low, f_high = dt * resistance(law, h, 0.0, n) - w, dt * resistance(law, h, w, n)
    if f_low >= 0.0:
        return 0.0
    side = 0
    for _ in range(60):
        v = (low * f_high - high * f_low) / (f_high - f_low)
        f = v + dt * resistance(law, h, v, n) - w
        if abs(f) <= 2e-16 * w or high - low <= 1e-15 * w:
            return v
        if f > 0.0:
            high, f_high = v, f
            f_low = 0.5 * f_low if side == 1 else f_low
            side = 1
        else:
            low, f_low = v, f
            f_high = 0.5 * f_high if side == -1 else f_high
            side = -1
    return high


@short_question
def brought(law: Any, h: float, w: float, dt: float, n: float) -> float:
    """The deceleration that the law brings to bear on a speed w in dt: (w - v)/dt, or what it holds."""
    if not h > LEAST:
        return w / dt
    v = after(law, h, w, dt, n)
    return (w - v) / dt if v > 0.0 else resistance(law, h, 0.0, n)


@short_question
def brought_midway(law: Any, h: float, u: float, h1: float, w: float, dt: float, acts: float, n: float) -> float:
    """The same in a step of second order from (h, u) to h1: a trapezoid, backward Euler where a cell stops or turns.

    `acts` = dt H/h1 is the time that the height H, on which the impulse acts, is worth.
    """
    if u * w > 0.0 and min(h, h1) > LEAST:
        explicit = abs(w) - 0.5 * dt * (h / h1) * resistance(law, h, abs(u), n)
        v = after(law, h1, explicit, 0.5 * dt, n) if explicit > 0.0 else 0.0
        if v > 0.0:
            return (abs(w) - v) / acts
    return brought(law, h1, abs(w), acts, n)


def law_of(friction: Any) -> Any:
    """A law of friction as kernels take it: a tuple of its numbers, whose class has its formulas.

    Raises:
        InputError: It has no formula `resistance`, or a number of it is none.
    """
    friction = friction if hasattr(friction, "resistance") else getattr(friction, "law", friction)
    if isinstance(friction, tuple) and hasattr(friction, "_fields"):
        cls, numbers = type(friction), tuple(friction)
    elif is_dataclass(friction):
        names = tuple(f.name for f in fields(friction) if isinstance(getattr(friction, f.name), (int, float)))
        cls, numbers = _tuple_class(type(friction), names), tuple(getattr(friction, name) for name in names)
    else:
        raise InputError(f"friction: {type(friction).__name__} is no law; give a NamedTuple or dataclass of numbers")
    if not callable(getattr(cls, "resistance", None)):
        raise InputError(f"friction: {cls.__name__} has no formula resistance(law, h, v, n)")
    return as_it_reads(cls)(*map(float, numbers))


def as_it_reads(cls: type) -> type:
    """The class, or another one like it where values that its formulas read have changed since it was compiled."""
    made_of = getattr(cls, "made_of", cls)
    if is_built_in(made_of):
        return cls
    reading = _readings.setdefault(cls, {})
    text = told(made_of)
    if text not in reading:
        again = {"made_of": made_of, "__module__": cls.__module__, "__qualname__": cls.__qualname__}
        reading[text] = type(cls.__name__, (cls,), again) if reading else cls
    return reading[text]


_readings: dict[type, dict[str, type]] = {}


@cache
def _tuple_class(cls: type, names: tuple[str, ...]) -> type:
    """A tuple of the numbers of a dataclass, with its formulas."""
    formulas: dict[str, Callable[..., Any]] = {name: getattr(cls, name) for name in FORMULAS if hasattr(cls, name)}
    made = NamedTuple(cls.__name__, [(name, float) for name in names])  # type: ignore[misc]
    for name, formula in formulas.items():
        setattr(made, name, formula)
    made.made_of = cls  # type: ignore[attr-defined]
    made.__module__ = cls.__module__ if cls.__module__ in sys.modules else "__main__"
    return made  # type: ignore[return-value]
