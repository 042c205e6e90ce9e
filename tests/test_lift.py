"""Cells that leave the ground: friction off, counted, named, and a stop where one is asked for."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kinsim
from kinsim import Arc, Cells, Coulomb, Courant, Fitted, Fixed, Kinetic, Macroscopic, Profile, Scene, SmoothChute
from kinsim.plot.bed import Bed

HILL = Scene(
    Cells(-0.5, 0.5, 20), Profile(np.ones(20), np.full(20, 3.0)), SmoothChute(Arc(-5.0), 1.0), Coulomb(0.4), "open", 0.4
)
"""kappa = -1/5: a stream with u^2 > 5 leaves the top of the hill."""


@pytest.mark.parametrize("method", [Macroscopic(), Macroscopic(statics="reflect"), Kinetic(velocity=Fitted(6))])
def test_no_friction_where_the_normal_force_would_pull(method: Kinetic | Macroscopic) -> None:
    """Of the step of one cell at the top only the pull of the slope is left."""
    flat = replace(HILL, cells=Cells(-1e-6, 1e-6, 20))
    run = kinsim.simulate(flat, method, Fixed(1e-8, 20))
    assert np.abs(run.u[-1] - 3.0).max() <= 1e-12
    slower = replace(flat, heap=Profile(np.ones(20), np.full(20, 2.0)))
    run = kinsim.simulate(slower, method, Fixed(1e-8, 20))
    braked = math.tan(0.4) * (1.0 - 4.0 / 5.0) * 2e-7
    np.testing.assert_allclose(2.0 - run.u[-1], braked, rtol=1e-5)


def test_cells_are_counted_and_named(tmp_path: Path) -> None:
    run = kinsim.simulate(HILL, Macroscopic(), Fixed(0.01, 10), save_every=2)
    books = run.entries
    assert (books["lifted"][1:] == 20).all()
    assert books["lifted_from"][-1] == pytest.approx(-0.475)
    assert books["lifted_to"][-1] == pytest.approx(0.475)
    assert books["lifted_since"][-1] == 0.0
    assert books["normal_force"][-1] < 0.0
    assert "20 cells left the ground, first at t = 0, in x = -0.475 to 0.475" in str(run.verdict)
    import xarray

    with xarray.open_dataset(run.to_netcdf(tmp_path / "run.nc"), engine="h5netcdf") as stored:
        assert float(stored["lifted_from"][-1]) == pytest.approx(-0.475)


def test_strict_chute_stops_the_run() -> None:
    strict = replace(HILL, chute=replace(HILL.chute, lifting="stop"))
    run = kinsim.simulate(strict, Macroscopic(), Fixed(0.01, 10))
    assert (run.verdict.kind, run.steps) == ("lifted-off", 0)
    gentle = replace(strict, heap=Profile(np.ones(20), np.full(20, 1.0)))
    assert kinsim.simulate(gentle, Macroscopic(), Fixed(0.01, 10)).verdict.kind == "finished"


def test_bed_is_as_long_as_it_is_along_the_ground() -> None:
    """An arc of radius 5: its chord and its rise; and thickness stands square on it."""
    bed = Bed.of(replace(HILL, cells=Cells(-2.0, 2.0, 40), heap=kinsim.Expression("1")), 1.0)
    assert bed.across[-1] == pytest.approx(2 * 5.0 * math.sin(0.4), rel=1e-9)
    assert bed.down.max() == pytest.approx(5.0 * (1.0 - math.cos(0.4)), rel=1e-6)
    x, z = bed.surface(np.ones(40))
    np.testing.assert_allclose(np.hypot(x - bed.across, z - bed.down), bed.thickness, rtol=1e-12)
    along = np.diff(bed.across) * (bed.normal[0, 1:] + bed.normal[0, :-1]) + np.diff(bed.down) * (
        bed.normal[1, 1:] + bed.normal[1, :-1]
    )
    np.testing.assert_allclose(along, 0.0, atol=1e-6)
    assert bed.factor in (1.0, 2.0, 5.0)


@pytest.mark.parametrize("name", ["bend", "bend-pressed", "exponential", "jump", "crest", "rest-gallery"])
def test_built_in_chutes_run_and_are_drawn(name: str, tmp_path: Path) -> None:
    scene, method, clock = kinsim.load_scene(name)
    coarse = replace(scene, cells=replace(scene.cells, count=48))
    clock = replace(clock, end=2.0) if isinstance(clock, Courant) else replace(clock, steps=20)
    run = kinsim.simulate(coarse, replace(method, velocity=kinsim.Uniform(32)), clock)
    assert run.verdict.kind in ("finished", "at-rest")
    assert abs(run.mass_drift) <= 1e-14
    from kinsim.plot.run import plot_run

    assert plot_run(run, tmp_path / "chute.png").stat().st_size > 10_000
    assert (name == "rest-gallery") == np.array_equal(run.h[-1], run.h[0])
    if name == "bend":
        film = kinsim.animate(run, tmp_path / "chute.gif", frames=3)
        assert film
