"""Studies: what the mechanism adds to each of 1000 short members, beside a run of 0.1 s."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np
from rows import Row, most

RUN = 0.1
"""Seconds of the run that the overhead is held against."""

ROUNDS = 3


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this file."""
    from kinsim import ConstantSlope, Fixed, Macroscopic, load_scene, simulate, study

    scene, method, clock = load_scene("silo")[0], Macroscopic(), Fixed(1e-3, 10)
    slopes = np.linspace(0.0, 0.3, 100 if quick else 1000)

    def bare(slopes: np.ndarray) -> None:
        for zeta in slopes:
            simulate(replace(scene, chute=ConstantSlope(float(zeta))), method, clock, 2**62)

    with tempfile.TemporaryDirectory() as folder:

        def kept(slopes: np.ndarray) -> None:
            study(scene, method, clock, {"chute.zeta": slopes}, keep=Path(folder) / "kept")

        ways: dict[str, Callable[[np.ndarray], None]] = {
            "bare": bare,
            "nothing kept": lambda slopes: study(scene, method, clock, {"chute.zeta": slopes}),
            "each kept": kept,
        }
        found: dict[str, list[float]] = {name: [] for name in ways}
        bare(slopes[:2])
        for _ in range(ROUNDS):
            for name, way in ways.items():
                began = time.perf_counter()
                way(slopes)
                found[name].append((time.perf_counter() - began) / slopes.size)
    for name in ("nothing kept", "each kept"):
        more = median(found[name]) - median(found["bare"])
        detail = f"{1e3 * more:.2g} ms on top of {1e3 * median(found['bare']):.2g} ms, {slopes.size} members"
        yield most(f"overhead of a member of a study, {name} / a run of {RUN:g} s", more / RUN, 0.05, detail)
