"""What varies: dotted paths with lists of values, and the members that follow."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import is_dataclass
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from ..clock import Courant, Fixed
from ..errors import InputError
from ..expression import evaluate
from ..method import Kinetic, Macroscopic
from ..read import check, put, take_method, toml_value
from ..scene import Scene
from .member import Member, Refused, Request

Over = Mapping[str, Sequence[Any]]

MOST = 1_000_000
"""Members that the table of a study holds: each takes about a kilobyte, and all are in memory at once."""


def check_over(over: Over, paired: bool) -> dict[str, list[Any]]:
    """`over` with lists.

    Raises:
        InputError: Nothing varies, a list is empty, or paired lists are of unlike length.
    """
    if not isinstance(over, Mapping) or not over:
        raise InputError("study: nothing varies; give over = {'chute.zeta': [0, 0.1]}, or --over chute.zeta=0,0.1")
    lists: dict[str, list[Any]] = {}
    for path, values in over.items():
        if not isinstance(path, str):
            raise InputError(f"study: over {path!r}: is no key; write a dotted path such as 'chute.zeta'")
        if isinstance(values, str) or not isinstance(values, (Sequence, np.ndarray)) or getattr(values, "ndim", 1) == 0:
            raise InputError(f"study: over {path}: should be a list of values, got a {type(values).__name__}")
        lists[path] = [value.item() if isinstance(value, np.generic) else value for value in values]
        if not lists[path]:
            raise InputError(f"study: over {path}: the list is empty; give at least one value")
    lengths = {path: len(values) for path, values in lists.items()}
    if paired and len(set(lengths.values())) > 1:
        told = ", ".join(f"{length} of {path}" for path, length in lengths.items())
        raise InputError(f"study: paired lists are of one length, and there are {told}; make them alike")
    many = max(lengths.values()) if paired else math.prod(lengths.values())
    if many > MOST:
        raise InputError(f"study: {many} members are more than a table in memory holds; take at most {MOST}")
    return lists


def vary(
    scene: Scene,
    method: Kinetic | Macroscopic,
    clock: Fixed | Courant,
    over: Mapping[str, list[Any]],
    paired: bool,
    request: Request,
) -> list[Member | Refused]:
    """The members in the order of the lists, the last varying fastest.

    Raises:
        InputError: Not one of them can be run.
    """
    found: list[Member | Refused] = []
    for values in (zip if paired else itertools.product)(*over.values()):
        found.append(_member(scene, method, clock, dict(zip(over, values, strict=True)), request))
    if all(isinstance(one, Refused) for one in found):
        first = found[0]
        raise InputError(first.message if isinstance(first, Refused) else "")
    return found


def _member(
    scene: Scene, method: Kinetic | Macroscopic, clock: Fixed | Courant, changes: dict[str, Any], request: Request
) -> Member | Refused:
    keys = {**dump(scene), "method": dump(method), "clock": dump(clock)}
    try:
        for path, value in sorted(changes.items(), key=_first_the_kinds):
            _change(keys, path, value)
        file = check(keys, "study")
        return Member(file.scene, file.method, file.clock, request)
    except InputError as error:
        return Refused(str(error))


def dump(given: Any) -> dict[str, Any]:
    """A scene, a method or a clock as keys of a scene file."""
    keys: dict[str, Any] = TypeAdapter(type(given)).dump_python(given)
    return keys


def _first_the_kinds(change: tuple[str, Any]) -> tuple[bool, int]:
    """A table comes before its kind, and this before its other keys."""
    path = change[0]
    return (not path.endswith(".kind") and path.count(".") > 0, path.count("."))


def _change(keys: dict[str, Any], path: str, value: Any) -> None:
    """Put `value` at `path`; another kind leaves nothing of the table that it was in, but for keys both wings know."""
    place = f"study: over {path}"
    value = dump(value) if is_dataclass(value) else value
    if path == "method.kind":
        take_method(keys, value)
    elif path.endswith(".kind"):
        put(keys, path.removesuffix(".kind"), {"kind": value}, place)
    else:
        put(keys, path, value, place)


def read_over(requests: Sequence[str]) -> dict[str, list[Any]]:
    """Lists from the command line: ``chute.zeta=0:pi/6:7`` (from, to, how many) or ``method.velocity.count=64,128``.

    Raises:
        InputError: One is neither.
    """
    over: dict[str, list[Any]] = {}
    for request in requests:
        path, equals, text = request.partition("=")
        path = path.strip()
        if not equals or not text.strip() or not path:
            raise InputError(f"--over {request}: is not KEY=VALUES; write for example --over chute.zeta=0,0.1,0.2")
        if path in over:
            raise InputError(f"--over {request}: {path} is named twice; give all its values at once")
        over[path] = list(_values(text, request))
    return over


def _values(text: str, request: str) -> Iterator[Any]:
    listed = toml_value(f"[{text}]")
    if isinstance(listed, list):
        yield from listed
    elif text.count(":") == 2 and "," not in text:
        yield from _range(text, request)
    else:
        yield from (toml_value(part) for part in text.split(","))


def _range(text: str, request: str) -> list[float] | list[int]:
    start, stop, many = text.split(":")
    try:
        first, last, count = float(evaluate(start)), float(evaluate(stop)), int(many)
    except ValueError as error:
        raise InputError(f"--over {request}: {error}; write FROM:TO:HOW-MANY, for example 0:0.5:11") from None
    if count < 2:
        raise InputError(f"--over {request}: {count} values make no range; take 2 or more")
    if count > MOST:
        raise InputError(f"--over {request}: {count} values are more than a table in memory holds; take at most {MOST}")
    values = np.linspace(first, last, count)
    whole = all(part.strip().lstrip("-").isdigit() for part in (start, stop)) and (values == np.rint(values)).all()
    return [int(one) for one in values] if whole else [float(one) for one in values]
