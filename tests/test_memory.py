"""What memory cannot hold is refused, with the number of bytes, before it is asked for."""

from __future__ import annotations

import sys
from types import SimpleNamespace

import numpy as np
import psutil
import pytest

from kinsim import (
    Cells,
    Courant,
    Expression,
    Fixed,
    InputError,
    Kinetic,
    Macroscopic,
    Scene,
    Uniform,
    load_scene,
    simulate,
)  # fmt: skip


def test_cells_beyond_memory_are_refused() -> None:
    """Whatever machine this is."""
    with pytest.raises(InputError, match=r"1000000000000000 cells would take 4e\+17 bytes .*take fewer"):
        Cells(0, 1, 10**15)


def test_a_density_beyond_memory_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """By what is free, not by what is built in; fluxes in closed form still have room."""
    monkeypatch.setattr(psutil, "virtual_memory", lambda: SimpleNamespace(available=2**30))
    scene = load_scene("silo")[0]
    for method in (Kinetic(velocity=Uniform(10**6, 5.0)), Kinetic(3, Uniform(10**6, 5.0))):
        with pytest.raises(InputError, match="densities of 320 x 1000000 entries would take"):
            simulate(scene, method, Fixed(1e-3, 2))
    assert simulate(scene, Macroscopic(), Fixed(1e-3, 2)).steps == 2


def test_memory_that_gets_short_costs_no_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that takes more rows than foreseen is refused where they no longer fit, and keeps its last good state."""
    dam = Scene(Cells(0.0, 1.0, 40), Expression("1e-6 + 1e3*(x < 0.1)"))
    whole = simulate(dam, Macroscopic(), Courant(0.9, 0.02), save_every=1)
    asked: list[int] = []

    def short(rows: int, steps: int, cells: int, what: str) -> None:
        asked.append(rows)
        if len(asked) > 1:
            raise InputError(f"{what} would take 1e99 bytes, 1 GiB are free; take fewer")

    monkeypatch.setattr(Courant, "steps_at", lambda *asked: 3)
    monkeypatch.setattr(sys.modules["kinsim.diagnostics.history"], "require_history", short)
    run = simulate(dam, Macroscopic(), Courant(0.9, 0.02), save_every=1)
    assert len(asked) == 2
    assert run.verdict.kind == "refused"
    assert 3 <= run.steps < whole.steps
    np.testing.assert_array_equal(run.h[-1], whole.h[run.steps])
    assert len(run.t) == run.steps + 1 == len(run.entries["mass"])
