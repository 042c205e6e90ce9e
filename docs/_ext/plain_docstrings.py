"""Docstrings of kinsim are plain text with words in backticks, and not reStructuredText: make that of them."""

from __future__ import annotations

import re
from typing import Any

from sphinx.application import Sphinx

import kinsim

CODE = re.compile(r"(``.*?``|`[^`]*`)")
KIND = re.compile(r"(?:, )?\*, kind='[\w-]+'")
SPECIAL = re.compile(r"[|*]|(?<=\w)_(?=\W|$)")
BEFORE_NAPOLEON = 100


def setup(app: Sphinx) -> dict[str, Any]:
    """Mend docstrings before their sections are read."""
    app.connect("autodoc-process-docstring", escape, priority=BEFORE_NAPOLEON)
    app.connect("autodoc-process-signature", shorten)
    return {"parallel_read_safe": True}


def escape(app: Sphinx, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Bars, stars and underscores stand for themselves; backticks hold code, which is a link if it is a public name."""
    for number, line in enumerate(lines):
        parts = CODE.split(line)
        parts[::2] = [SPECIAL.sub(r"\\\g<0>", part) for part in parts[::2]]
        parts[1::2] = [_code(part.strip("`")) for part in parts[1::2]]
        lines[number] = "".join(parts)


def _code(word: str) -> str:
    public = word.removeprefix("kinsim.")
    return f":py:obj:`~kinsim.{public}`" if public in kinsim.__all__ else f"``{word}``"


def shorten(app: Sphinx, what: str, name: str, thing: Any, options: Any, given: str | None, back: str | None) -> Any:
    """The word by which a scene file chooses a class is no argument that anybody gives."""
    return KIND.sub("", given) if given else given, back
