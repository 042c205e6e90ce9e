"""Sleeping cells are skipped bit-identically, and wake in time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from repaired import METHODS
from states import scene_with

from kinsim import Fixed, Kinetic, Macroscopic, Uniform, simulate, sleep
from kinsim.simulate import Loop

CASES = {name: method for name, method in METHODS.items() if not name.startswith("matched")}
CASES |= {"scheme 1": Macroscopic(1), "scheme 1, grid": Kinetic(1, Uniform(16))}


def heaps(boundary: str, cells: int = 320):  # type: ignore[no-untyped-def]
    """Two heaps far from each other on flat ground: one stands, the other falls; a moving block comes later."""
    x = (np.arange(cells) + 0.5) / cells
    h = np.where(np.abs(x - 0.3) < 0.04, 0.8, 0.0) + np.maximum(0.2 - 8 * np.abs(x - 0.7), 0.0)
    u = np.where(np.abs(x - 0.3) < 0.04, 0.6, 0.0)
    return scene_with(h, u, delta=0.5, boundary=boundary)


@pytest.mark.parametrize("boundary", ["wall", "periodic"])
@pytest.mark.parametrize("name", CASES)
def test_a_run_with_sleepers_is_the_run_without(name: str, boundary: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every saved state, the ledger and the verdict, compared with ==; and some cells did sleep."""
    scene, method, clock = heaps(boundary), CASES[name], Fixed(0.01, 200)
    rested = simulate(scene, method, clock, 50)
    monkeypatch.setattr(sleep, "_may_sleep", lambda method: False)
    plain = simulate(scene, method, clock, 50)
    np.testing.assert_array_equal(rested.h, plain.h)
    np.testing.assert_array_equal(rested.q, plain.q)
    for column, values in plain.entries.items():
        np.testing.assert_array_equal(rested.entries[column], values, err_msg=column)
    assert rested.verdict == plain.verdict


@pytest.mark.parametrize("name", CASES)
def test_cells_sleep(name: str) -> None:
    """Not all cells are computed, though scheme 1 rests on dry ground only; a mass at rest costs the saved steps."""
    method = CASES[name] if isinstance(CASES[name], Macroscopic) else CASES[name].within(2.0)
    loop = Loop(heaps("wall"), method, Fixed(0.01, 200), 50, False)
    loop.start()
    loop.run(None, type("Never", (), {"asked": False})())
    assert loop.awake.cell_steps < 200 * 320 * (0.75 if method.scheme == 4 else 0.98)
    if method.scheme == 4:
        x = (np.arange(320) + 0.5) / 320
        still = scene_with(np.maximum(0.2 - 8 * np.abs(x - 0.7), 0.0), delta=0.5, boundary="wall")
        loop = Loop(still, method, Fixed(0.01, 200), 50, False)
        loop.start()
        loop.run(None, type("Never", (), {"asked": False})())
        assert loop.awake.cell_steps <= 320 * (200 // 50 + 2)


def test_a_sleeper_is_woken(monkeypatch: pytest.MonkeyPatch) -> None:
    """A block slides into a standing heap, which sleeps until then and moves from then on, as it would have."""
    x = (np.arange(320) + 0.5) / 320
    h = np.where(np.abs(x - 0.3) < 0.04, 1.0, 0.0) + np.maximum(0.2 - 8 * np.abs(x - 0.5), 0.0)
    scene = scene_with(h, np.where(np.abs(x - 0.3) < 0.04, 2.0, 0.0), delta=0.25, boundary="wall")
    clock = Fixed(0.01, 600)
    rested = simulate(scene, Macroscopic(4), clock, 30)
    monkeypatch.setattr(sleep, "_may_sleep", lambda method: False)
    np.testing.assert_array_equal(rested.h, simulate(scene, Macroscopic(4), clock, 30).h)
    standing = np.abs(x - 0.5) < 0.02
    assert (rested.h[1][standing] == h[standing]).all()
    assert (rested.h[-1][standing] != h[standing]).all()


def test_a_reach_too_short_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """With a reach of no cell the bits differ: the test above can fail."""
    scene, method, clock = heaps("wall"), replace(CASES["closed, first"], order=2), Fixed(0.01, 200)
    plain = simulate(scene, method, clock, 50)
    monkeypatch.setattr(sleep, "REACH", 0)
    monkeypatch.setattr(sleep, "BLOCK", 1)
    assert (simulate(scene, method, clock, 50).h != plain.h).any()
