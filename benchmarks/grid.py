"""Densities on a velocity grid: f stored in each step, or no density at all."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
import plain
from cases import Array, Case, bare, stored
from native import Native, library
from numba import njit
from rows import Row, least, most, skipped
from timing import Times, interleave, same

SIZES = ((400, 64), (2000, 256), (20000, 512))


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this file."""
    for nx, n in SIZES[: 2 if quick else 3]:
        yield from of_size(nx, n, quick)


def of_size(nx: int, n: int, quick: bool) -> Iterator[Row]:
    """The rows of one grid."""
    case, size = Case.dam(nx), f"{nx}x{n}"
    kept = stored(case, n)
    same(f"carried f, {size}, stages", kept.result(), kept.of_stages())
    calls: dict[str, Callable[[], object]] = {"stored": kept}
    if library():
        native = Native(case, n)
        same(f"C, {size}", kept.result(), native.result())
        calls["C"] = native
    main = (nx, n) == SIZES[1]
    if main:
        unseen = bare(case, n)
        same(f"window only, {size}, stages", unseen.result(), kept.of_stages())
        same(f"NumPy, {size}", kept.result(), plain.carried(case, n))
        calls |= {"bare": unseen, "NumPy": lambda: plain.carried(case, n), "sqrt": square_roots(nx * n)}
    times = interleave(calls, rounds=5 if quick or nx * n > 10**6 else 15)
    of = {name: time.words(nx * n * 1e-9, "ns") for name, time in times.items()}
    if library():
        yield ratio(f"carried f / C, {size}", times["stored"], times["C"], 1.5, f"{of['stored']}; C {of['C']}")
    else:
        yield skipped(f"carried f / C, {size}", "no C compiler")
    if main:
        yield ratio(f"carried f / a sqrt loop, {size}", times["stored"], times["sqrt"], 2.0, f"sqrt {of['sqrt']}")
        quotient = times["NumPy"].median / times["stored"].median
        yield least(f"NumPy / carried f, {size}", quotient, 15.0, f"NumPy {of['NumPy']}")
        yield ratio(f"window only, f not stored / carried f, {size}", times["bare"], times["stored"], 0.75, of["bare"])


def ratio(what: str, ours: Times, theirs: Times, high: float | None, detail: str) -> Row:
    """The quotient of two medians, which must not be greater."""
    return most(what, ours.median / theirs.median, high, detail)


def square_roots(count: int) -> Callable[[], object]:
    """As many square roots, from and to the first-level cache: nothing on a grid is faster."""
    block = np.linspace(0.1, 1.0, 2048)
    out = np.empty_like(block)
    return lambda: roots(block, out, count // block.size)


@njit(error_model="numpy")
def roots(given: Array, out: Array, repeats: int) -> None:
    """sqrt of each entry, several times."""
    for r in range(repeats):
        given[0] = 1.0 / (1.0 + r)  # or the compiler would do it once
        for i in range(given.size):
            out[i] = math.sqrt(given[i])
