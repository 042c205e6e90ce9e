"""The rows of the table: what was measured, and what it should have been."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One line of the table; `target` holds the least and the greatest value that meet it, None where there is none."""

    what: str
    measured: float | None
    target: tuple[float | None, float | None] = (None, None)
    detail: str = ""

    @property
    def verdict(self) -> str:
        """In a word."""
        if self.measured is None:
            return "skipped"
        low, high = self.target
        if low is None and high is None:
            return ""
        met = (low is None or self.measured >= low) and (high is None or self.measured <= high)
        return "met" if met else "missed"

    @property
    def words(self) -> str:
        """The target as people write it."""
        low, high = self.target
        if low is not None and high is not None:
            return f"{low:g} to {high:g}"
        return f">= {low:g}" if low is not None else f"<= {high:g}" if high is not None else ""


def most(what: str, measured: float | None, high: float | None, detail: str = "") -> Row:
    """A row that must not be greater."""
    return Row(what, measured, (None, high), detail)


def least(what: str, measured: float | None, low: float, detail: str = "") -> Row:
    """A row that must not be less."""
    return Row(what, measured, (low, None), detail)


def skipped(what: str, why: str) -> Row:
    """A row that this machine cannot measure."""
    return Row(what, None, (None, None), why)
