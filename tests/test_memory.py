"""What memory cannot hold is refused, with the number of bytes, before it is asked for."""

from __future__ import annotations

from types import SimpleNamespace

import psutil
import pytest

from kinsim import Cells, Fixed, InputError, Kinetic, Macroscopic, Uniform, load_scene, simulate


def test_cells_beyond_memory_are_refused() -> None:
    """Whatever machine this is."""
    with pytest.raises(InputError, match=r"1000000000000000 cells would take 4e\+17 bytes .*take fewer"):
        Cells(0, 1, 10**15)


def test_a_density_beyond_memory_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """By what is free, not by what is built in; fluxes in closed form still have room."""
    monkeypatch.setattr(psutil, "virtual_memory", lambda: SimpleNamespace(available=2**30))
    scene = load_scene("silo")[0]
    for method, entries in ((Kinetic(velocity=Uniform(10**6, 5.0)), 3), (Kinetic(3, Uniform(10**6, 5.0)), 5)):
        with pytest.raises(InputError, match=f"{entries} densities of 320 x 1000000 entries would take"):
            simulate(scene, method, Fixed(1e-3, 2))
    assert simulate(scene, Macroscopic(), Fixed(1e-3, 2)).steps == 2
