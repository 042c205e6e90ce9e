"""Frozen, validated values: what a scene, a method or a clock is made of.

pydantic does the checking, both for values written in Python and for those read from a scene file; this module only
adds the two number types that a scene file knows.
"""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass
from typing import Annotated, Any, TypeVar, dataclass_transform

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    Strict,
    TypeAdapter,
    ValidationError,
)  # fmt: skip
from pydantic.dataclasses import dataclass as validated_dataclass

from .errors import InputError
from .expression import evaluate
from .finding import one_line
from .source import is_built_in, told

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
            raise InputError(one_line(error, cls.__name__, made)) from None

    made.__init__ = __init__
    return made  # type: ignore[no-any-return]


def checked(place: str, family: Any, given: Any) -> Any:
    """`given` as a number of the `family`, for what is no field of a value; `place` names it.

    Raises:
        InputError: It is none.
    """
    try:
        return TypeAdapter(family, config=ConfigDict(allow_inf_nan=False)).validate_python(given)
    except ValidationError as error:
        raise InputError(one_line(error, place, family)) from None


def described_outside(given: Any, write: SerializerFunctionWrapHandler) -> Any:
    """A part as keys and values; one from outside of the package by its class, its numbers and a hash of its source."""
    own = given if hasattr(given, "__qualname__") else type(given)
    if isinstance(given, (dict, str, type(None))) or is_built_in(own):
        return write(given)
    told = {"outside": f"{own.__module__}.{own.__qualname__}", "source": source_hash(own)}
    return told | ({} if own is given else {"numbers": repr(given)})


def source_hash(part: Any) -> str:
    """A hash of the source of a class or function, and of all that it reads."""
    return hashlib.sha256(told(part).encode()).hexdigest()


def of_outside(thing: Any, path: str = "") -> dict[str, str]:
    """Values in a value whose class is not one of the package, by their places: class and hash of its source."""
    found: dict[str, str] = {}
    if not is_dataclass(thing):
        return found
    cls = type(thing)
    if not is_built_in(cls):
        found[path or "itself"] = f"{cls.__module__}.{cls.__qualname__} {source_hash(cls)}"
    for field in fields(thing):
        found |= of_outside(getattr(thing, field.name), f"{path}.{field.name}" if path else field.name)
    return found


def kind(name: str) -> Any:
    """The word by which a scene file chooses this variant of its family."""
    return Field(default=name, repr=False, kw_only=True)
