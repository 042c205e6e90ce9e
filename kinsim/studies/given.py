"""What a caller may give to whatever takes many runs."""

from __future__ import annotations

from numbers import Integral
from typing import Any

from ..clock import Courant, Fixed
from ..errors import InputError
from ..method import Kinetic, Macroscopic
from ..scene import Scene


def check_given(who: str, scene: Any, method: Any, clock: Any) -> None:
    """A scene, a method and a clock in this order.

    Raises:
        InputError: One of them is something else; `who` was asked.
    """
    wanted = (
        ("scene", scene, Scene, "a kinsim.Scene; load_scene(NAME) gives scene, method and clock of a scene file"),
        ("method", method, (Kinetic, Macroscopic), "kinsim.Kinetic(...) or kinsim.Macroscopic(...)"),
        ("clock", clock, (Fixed, Courant), "kinsim.Fixed(dt, steps) or kinsim.Courant(number, end)"),
    )
    for name, given, kinds, remedy in wanted:
        if not isinstance(given, kinds):
            raise InputError(f"{who}: {name} is a {type(given).__name__}; give {remedy}")


def check_count(place: str, given: Any, remedy: str) -> None:
    """A whole number from 1 on.

    Raises:
        InputError: It is none.
    """
    if isinstance(given, bool) or not isinstance(given, Integral):
        raise InputError(f"{place} = {given!r} is no whole number; {remedy}")
    if given < 1:
        raise InputError(f"{place} = {given} is below 1; {remedy}")
