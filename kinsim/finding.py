"""What pydantic finds wrong with a value, as one line: the place, what is wrong there, and the remedy."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping
from dataclasses import is_dataclass
from typing import Any, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

UNKNOWN = ("unexpected_keyword_argument", "extra_forbidden")
MISSING = ("missing", "missing_argument")
A_TABLE = ("model_attributes_type", "dataclass_type", "dict_type")


def one_line(error: ValidationError, place: str, kind: Any, separator: str = ".") -> str:
    """The finding that helps most as one sentence.

    Args:
        error: What pydantic found in a value of the type `kind`.
        place: Where the value stands: the name of a class or of a file.
        kind: The type, a dataclass made by `value`.
        separator: Stands between the place and the key path.
    """
    findings = sorted(error.errors(include_url=False), key=lambda found: found["type"] not in UNKNOWN)
    paths = [_follow(kind, found["loc"])[0] for found in findings]
    inside = [number for number, path in enumerate(paths) if path.startswith(f"{paths[0]}[")]
    chosen = inside[0] if inside else 0
    more = len(set(paths)) - len({paths[0], paths[chosen]})
    where = f"{place}{separator}{paths[chosen]}" if paths[chosen] else place
    return f"{where}: {_sentence(findings[chosen], kind)}" + (f" (and {more} more)" if more else "")


def _follow(kind: Any, loc: tuple[int | str, ...]) -> tuple[str, Any]:
    """The key path to a finding, without the words pydantic adds for the chosen variant, and the type found there."""
    path = ""
    for step in loc:
        if step in _kinds(kind):
            kind = _kinds(kind)[str(step)]
        elif fields := _fields(kind):
            name = list(fields)[step] if isinstance(step, int) and step < len(fields) else str(step)
            path += f".{name}" if path else name
            kind = fields[name].annotation if name in fields else None
        elif isinstance(step, int):
            path += f"[{step}]"
    return path, kind


def _fields(kind: Any) -> Mapping[str, Any]:
    return getattr(kind, "__pydantic_fields__", {}) if is_dataclass(kind) else {}


def _sentence(found: ErrorDetails, kind: Any) -> str:
    kind_of_fault, message, given = found["type"], found["msg"], found["input"]
    if kind_of_fault in UNKNOWN:
        _, owner = _follow(kind, found["loc"][:-1])
        return f"unknown key; {_choice(found['loc'][-1], _fields(owner))}"
    _, wanted = _follow(kind, found["loc"])
    if kind_of_fault in MISSING:
        keys = [name for name in _fields(wanted) if name != "kind"] or ["kind" if _kinds(wanted) else "a value"]
        return f"missing; give it {', '.join(keys)}"
    if kind_of_fault in ("union_tag_not_found", "union_tag_invalid"):
        tag = found["ctx"].get("tag")
        return f"{'its kind is missing' if tag is None else f'no kind {tag!r}'}; {_choice(tag, _kinds(wanted))}"
    if kind_of_fault == "value_error":
        return message.removeprefix("Value error, ")
    if kind_of_fault in A_TABLE:
        names = [variant.__name__ for variant in _kinds(wanted).values() or [wanted]]
        message = f"should be a table of keys (in Python {' or '.join(names)})"
    message = message.replace("Input should", "should").replace(repr(math.pi / 2), "pi/2").replace("tuple", "list")
    return f"{message[:1].lower()}{message[1:]}, got {_shown(given)}"


def _kinds(family: Any) -> dict[str, Any]:
    """The variants of a family by their kinds."""
    return {_fields(variant)["kind"].default: variant for variant in get_args(family) if "kind" in _fields(variant)}


def _choice(name: Any, known: Iterable[str]) -> str:
    near = difflib.get_close_matches(str(name), known, n=1)
    return f"did you mean {near[0]}?" if near else f"choose from {', '.join(known)}"


def _shown(given: Any) -> str:
    if not isinstance(given, (int, float, str, bool)):
        return f"a {type(given).__name__}"
    shown = repr(given)
    return shown if len(shown) <= 40 else f"{shown[:37]}..."
