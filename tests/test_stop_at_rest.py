"""A clock that ends a run where the mass came to rest."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from states import scene_with

from kinsim import Courant, Fixed, Macroscopic, load_scene, simulate
from kinsim.clock import AnyClock


def collapse(film: float):
    """A heap that falls on flat ground."""
    x = (np.arange(48) + 0.5) / 48
    return scene_with(np.where(np.abs(x - 0.5) < 0.15, 1.0, film), delta=0.3, boundary="wall")


@pytest.mark.parametrize(
    ("scheme", "film", "clock"),
    [
        (4, 0.0, Fixed(0.01, 6000, stop_at_rest=True)),
        (4, 0.2, Courant(0.9, 60.0, stop_at_rest=True)),
        (3, 0.2, Fixed(0.005, 6000, stop_at_rest=True)),
    ],
)
def test_a_mass_that_came_to_rest_ends_the_run(scheme: int, film: float, clock: AnyClock) -> None:
    """Earlier than without, and in the state in which it then stays: bit for bit, or to rounding under scheme 3."""
    run = simulate(collapse(film), Macroscopic(scheme), clock)
    whole = simulate(collapse(film), Macroscopic(scheme), replace(clock, stop_at_rest=False))
    assert str(run.verdict).startswith("came to rest at t = ")
    assert run.verdict.kind == whole.verdict.kind == "at-rest"
    assert run.steps < 0.9 * whole.steps
    np.testing.assert_array_equal(run.dt, whole.dt[: run.steps])
    np.testing.assert_allclose(run.h[-1], whole.h[-1], atol=1e-9)


def test_what_flows_steadily_is_not_at_rest() -> None:
    """A uniform stream does not change, and goes on."""
    scene = scene_with(np.ones(8), np.full(8, 0.3), boundary="periodic")
    run = simulate(scene, Macroscopic(4), Fixed(1e-3, 50, stop_at_rest=True))
    assert run.steps == 50
    assert run.verdict.kind == "finished"


def test_the_clock_of_a_scene_may_say_so(tmp_path: Path) -> None:
    """In a file, too."""
    text = (
        "epsilon = 0.4\n[cells]\nleft = 0\nright = 1\ncount = 8\n[heap]\nkind = 'blocks'\nedges = []\nheights = [1]\n"
        "[friction]\nkind = 'coulomb'\ndelta = 0.3\n[clock]\nnumber = 0.5\nend = 9\nstop_at_rest = true\n"
    )
    (tmp_path / "a.toml").write_text(text)
    scene, method, clock = load_scene(tmp_path / "a.toml")
    run = simulate(scene, method, clock)
    assert run.steps == 1
    assert "came to rest" in str(run.verdict)
