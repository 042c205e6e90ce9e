"""No density: closed form and fitted nodes, the schemes compared, and what PyClaw takes for the same dam."""

from __future__ import annotations

import time
from collections.abc import Iterator

import plain
from cases import Call, Case, Step, stored
from dam_pyclaw import pyclaw_step
from grid import ratio
from native import Native, library
from rows import Row, least, most, skipped
from timing import interleave, same

from kinsim import Fitted, Fixed, Kinetic, Macroscopic, Uniform, simulate
from kinsim.method import SchemeNumber

CELLS = 10_000

BALANCED: tuple[SchemeNumber, ...] = (3, 4)
"""Schemes with faces of their own."""

PROMISED = {6: 1e-11, 8: 1e-14}
"""How near so many fitted nodes come to the closed form: their error is told of the flux, which is greater than q."""


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this file."""
    yield from at_size(quick)
    yield from schemes_on_grid(quick)
    yield from overhead(quick)


def at_size(quick: bool) -> Iterator[Row]:
    """The rows at 1e4 cells."""
    case = Case.dam(CELLS)
    calls = {f"scheme {scheme}": Step(case, Macroscopic(scheme)) for scheme in (1, *BALANCED)}
    calls |= {f"fitted {count}": Step(case, Kinetic(1, Fitted(count))) for count in PROMISED}
    for name, call in calls.items():
        same(f"{name}, stages", call.result(), call.of_stages())
    closed = calls["scheme 1"].result()
    same("NumPy, closed form", closed, plain.closed(case))
    for count, within in PROMISED.items():
        same(f"fitted {count}", calls[f"fitted {count}"].result(), closed, within)
    for scheme in BALANCED:
        fitted = Step(case, Kinetic(scheme, Fitted(8))).result()
        same(f"scheme {scheme}, fitted 8", calls[f"scheme {scheme}"].result(), fitted, PROMISED[8])
    others: dict[str, Call] = {"NumPy": lambda: plain.closed(case)}
    if library():
        others["C"] = native = Native(case)
        same("C, closed form", closed, native.result())
    pyclaw = pyclaw_step(case)
    if pyclaw:
        others["PyClaw"] = pyclaw
    times = interleave({**calls, **others}, rounds=7 if quick else 21)
    of = {name: time.words(CELLS * 1e-9, "ns per cell") for name, time in times.items()}
    one = times["scheme 1"]
    if library():
        yield ratio("closed form, scheme 1 / C, 1e4 cells", one, times["C"], 1.3, f"{of['scheme 1']}; C {of['C']}")
    else:
        yield skipped("closed form, scheme 1 / C", "no C compiler")
    yield least("formulas as printed in NumPy / closed form", times["NumPy"].median / one.median, 20.0, of["NumPy"])
    yield ratio("Fitted 6 / closed form", times["fitted 6"], one, 1.7, of["fitted 6"])
    yield ratio("Fitted 8 / closed form", times["fitted 8"], one, 2.0, of["fitted 8"])
    yield ratio("scheme 3 / scheme 1, closed form", times["scheme 3"], one, 3.2, of["scheme 3"])
    yield ratio("scheme 4 / scheme 1, closed form", times["scheme 4"], one, None, of["scheme 4"])
    for name, of_ours, low in (("closed form", one, 4.0), ("Fitted 6", times["fitted 6"], 3.0)):
        if pyclaw:
            quotient = times["PyClaw"].median / of_ours.median
            yield least(f"PyClaw order 1 / {name}, 1e4 cells", quotient, low, of["PyClaw"])
        else:
            yield skipped(
                f"PyClaw order 1 / {name}", "clawpack is not installed (pip install clawpack, with a Fortran compiler)"
            )


def schemes_on_grid(quick: bool) -> Iterator[Row]:
    """Scheme 3 and 4 against 1, f stored."""
    case, n = Case.dam(1000), 128
    calls = {f"scheme {scheme}": stored(case, n, scheme) for scheme in (1, *BALANCED)}
    for name, call in calls.items():
        same(f"{name}, f stored, stages", call.result(), call.of_stages())
    times = interleave(calls, rounds=5 if quick else 15)
    for scheme, high in ((3, 3.2), (4, None)):
        ours = times[f"scheme {scheme}"]
        detail = ours.words(case.h.size * n * 1e-9, "ns")
        yield ratio(f"scheme {scheme} / scheme 1, carried f, 1000x128", ours, times["scheme 1"], high, detail)


def overhead(quick: bool) -> Iterator[Row]:
    """A whole step of `simulate` with 50 cells, in microseconds."""
    case = Case.dam(50)
    on_grid = Kinetic(1, Uniform(32, case.bound), "sampled")
    methods: dict[str, Kinetic | Macroscopic] = {
        "closed form, scheme 1": Macroscopic(1),
        "closed form, scheme 4": Macroscopic(4),
        "Fitted 6, scheme 1": Kinetic(1, Fitted(6)),
        "32 nodes, scheme 1": on_grid,
    }
    for name, method in methods.items():
        low, middle, high = loop(case, method, 500 if quick else 2000)
        spread = f"{1e6 * low:.3g} / {1e6 * middle:.3g} / {1e6 * high:.3g} us"
        yield most(f"a whole step with 50 cells, microseconds: {name}", 1e6 * middle, 40.0, spread)


def loop(case: Case, method: Kinetic | Macroscopic, steps: int) -> tuple[float, float, float]:
    """Least, median and greatest seconds of the thread per step of `simulate`: what more steps add to a first one."""

    def once(count: int) -> float:
        began = time.thread_time()
        simulate(case.scene, method, Fixed(1e-6, count), 10**9)
        return time.thread_time() - began

    once(1)
    found = sorted((once(steps + 1) - once(1)) / steps for _ in range(5))
    return found[0], found[2], found[-1]
