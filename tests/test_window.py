"""Windows that follow the occupied velocities, and windows that are too small."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import SCENES

from kinsim import (
    Cells,
    Fixed,
    Kinetic,
    Uniform,
    Window,
    simulate,
)
from kinsim.kinetic.equilibrium import EQUILIBRIA, EquilibriumName


@pytest.mark.parametrize("equilibrium", EQUILIBRIA)
def test_window_is_the_uniform_grid_where_something_is(equilibrium: EquilibriumName) -> None:
    """Only empty velocity cells are left out: every state equals that on a grid wide enough, bit for bit."""
    scene = replace(SCENES["sine"][0], cells=Cells(-3, 11, 56))
    wide = simulate(scene, Kinetic(1, Uniform(120, 6.0), equilibrium), Fixed(5e-3, 300), 50)
    follow = simulate(scene, Kinetic(1, Window(0.1), equilibrium), Fixed(5e-3, 300), 50)
    if equilibrium == "entropic":  # its sums run over the whole grid and round differently
        np.testing.assert_allclose(follow.h, wide.h, atol=1e-12)
    else:
        np.testing.assert_array_equal(follow.h, wide.h)
        np.testing.assert_array_equal(follow.q, wide.q)
    assert follow.verdict.kind == wide.verdict.kind
    assert follow.entries["window_loss"][-1] == 0.0


def test_window_grows_and_shrinks_with_the_velocities() -> None:
    grid = Window(0.1).grid(1.0)
    assert grid.bound >= 1.0
    assert Window(0.1).fits(grid, 1.0)
    assert not Window(0.1).fits(grid, 1.5)
    assert not Window(0.1).fits(Window(0.1).grid(9.0), 1.0)


def test_a_window_too_small_warns_on_request_and_books_what_it_cut() -> None:
    """`beyond="warn"`: the run goes on, the verdict has the numbers, the ledger has the loss."""
    scene = replace(SCENES["silo"][0], cells=Cells(-8, 8, 80))
    stopped, warned = (
        simulate(scene, Kinetic(1, Uniform(64, 1.2, beyond)), Fixed(5e-3, 100), 20) for beyond in ("stop", "warn")
    )
    assert stopped.verdict.kind == "window-too-small"
    assert warned.verdict.kind == "finished"
    assert "outside the window of 1.2 (take a bound of 1.4" in str(warned.verdict)
    assert warned.entries["window_loss"][-1] > 0.0
