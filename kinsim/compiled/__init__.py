"""How formulas become machine code; the only place that knows numba."""

from __future__ import annotations

from .apart import Apart, perform
from .cache import cache_folder, source_stamp, stamped
from .kernel import (
    answers,
    at,
    formula,
    generic,
    greatest,
    kernel,
    plain,
    question,
    routine,
    short_question,
    shortened,
)

__all__ = [
    "Apart", "answers", "at", "cache_folder", "formula", "generic", "greatest", "kernel", "perform", "plain",
    "question", "routine", "short_question", "shortened", "source_stamp", "stamped",
]  # fmt: skip
