"""How the cost grows with cells and with velocity nodes: exponents, 1 if each costs the same."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from cases import Case, Step, bare, stored
from rows import Row
from timing import exponent, interleave

from kinsim import Fitted, Kinetic, Macroscopic

CELLS = (1_000, 10_000, 100_000)
NODES = (128, 512, 2048, 4096)
BOUNDS = (0.95, 1.1)


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this file."""
    cases = {nx: Case.dam(nx) for nx in CELLS[: 2 if quick else 3]}
    kinds: dict[str, Callable[[Case], Step]] = {
        "closed form": lambda case: Step(case, Macroscopic(1)),
        "Fitted 6": lambda case: Step(case, Kinetic(1, Fitted(6))),
        "carried f, 64 nodes": lambda case: stored(case, 64),
        "window only, 64 nodes": lambda case: bare(case, 64),
    }
    for name, make in kinds.items():
        yield growth(f"cost exponent in cells, {name}", {nx: make(case) for nx, case in cases.items()}, quick)
    case = Case.dam(200)
    nodes = NODES[: 3 if quick else 4]
    yield growth("cost exponent in velocity nodes, carried f", {n: stored(case, n) for n in nodes}, quick)
    yield growth("cost exponent in velocity nodes, window only", {n: bare(case, n) for n in nodes}, quick)


def growth(what: str, calls: dict[int, Step], quick: bool) -> Row:
    """The exponent between the least and the greatest size."""
    times = interleave({str(size): call for size, call in calls.items()}, rounds=5 if quick else 9)
    medians = [time.median for time in times.values()]
    detail = ", ".join(f"{size}: {1e6 * median:.3g} us" for size, median in zip(calls, medians, strict=True))
    return Row(what, exponent(list(calls), medians), BOUNDS, detail)
