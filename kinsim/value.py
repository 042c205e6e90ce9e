"""Frozen, validated values: what a scene, a method or a clock is made of.

pydantic does the checking, both for values written in Python and for those read from a scene file; this module only
turns its findings into one line each, and adds the two number types that a scene file knows.
"""

from __future__ import annotations

import difflib
from dataclasses import fields
from typing import Annotated, Any, TypeVar, dataclass_transform

from pydantic import BeforeValidator, ConfigDict, Field, Strict, ValidationError
from pydantic.dataclasses import dataclass as validated_dataclass
from pydantic_core import ErrorDetails

from .errors import InputError
from .expression import evaluate

T = TypeVar("T")

CONFIG = ConfigDict(extra="forbid", allow_inf_nan=False, arbitrary_types_allowed=True)


def _number(given: Any) -> Any:
    """Read ``"pi/10"`` as the paper writes it, and numpy scalars as numbers."""
    if isinstance(given, str):
        return evaluate(given)
    return given.item() if getattr(given, "shape", None) == () else given


Number = Annotated[float, Strict(), BeforeValidator(_number)]
"""A finite number, or a formula without variables such as ``"pi/10"``."""

Whole = Annotated[int, Strict(), BeforeValidator(lambda given: _number(given) if not isinstance(given, str) else given)]
"""A whole number."""


@dataclass_transform(frozen_default=True)
def value(cls: type[T]) -> type[T]:
    """Make `cls` a frozen dataclass whose fields are checked; a bad one raises `InputError` with one line."""
    made: Any = validated_dataclass(frozen=True, config=CONFIG)(cls)
    checked = made.__init__

    def __init__(self: Any, *args: Any, **given: Any) -> None:
        try:
            checked(self, *args, **given)
        except ValidationError as error:
            raise InputError(one_line(error, cls.__name__, known=[f.name for f in fields(made)])) from None

    made.__init__ = __init__
    return made


def kind(name: str) -> Any:
    """The word by which a scene file chooses this variant of its family."""
    return Field(default=name, repr=False, kw_only=True)


def one_line(error: ValidationError, place: str, known: list[str] | None = None) -> str:
    """The first finding of a validation as one sentence: place, what is wrong, what would be right."""
    found = error.errors(include_url=False)
    first = found[0]
    where = ".".join([place, *_path(first)])
    more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
    return f"{where}: {_sentence(first, known)}{more}"


def _path(found: ErrorDetails) -> list[str]:
    """The keys that lead to the fault, without the words that pydantic adds for the chosen variant."""
    steps = list(found["loc"])
    if found["type"] == "unexpected_keyword_argument" and not steps:
        return []
    return [str(step) for step in steps if not str(step).startswith(("tagged-union", "function-"))]


def _sentence(found: ErrorDetails, known: list[str] | None) -> str:
    kind_of_fault, message = found["type"], found["msg"]
    if kind_of_fault in ("unexpected_keyword_argument", "extra_forbidden"):
        name = str(found["loc"][-1])
        near = difflib.get_close_matches(name, known or [], n=1)
        hint = f"did you mean {near[0]}?" if near else f"known here: {', '.join(known)}" if known else "remove it"
        return f"unknown key; {hint}"
    if kind_of_fault in ("missing", "missing_argument"):
        return "missing; give it a value"
    if kind_of_fault == "value_error":
        return message.removeprefix("Value error, ")
    given = found.get("input")
    shown = repr(given) if isinstance(given, (int, float, str, bool)) else type(given).__name__
    return f"{message[:1].lower()}{message[1:]}, got {shown[:60]}"
