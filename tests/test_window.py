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
    Profile,
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


def test_a_window_reaches_beyond_the_velocities() -> None:
    """To `margin` times them, in whole cells."""
    for reach in (1.0, 1.5, 9.0):
        assert 1.1 * reach <= Window(0.1).grid(reach).bound <= 1.1 * reach + 0.1 + 1e-12


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


def test_the_last_row_is_of_the_last_step_however_the_window_moves() -> None:
    """A window that is made anew at the end does not empty f before it is booked."""
    scene = replace(SCENES["sine"][0], cells=Cells(-3, 11, 28))
    for steps in range(30, 60):
        run = simulate(scene, Kinetic(1, Window(0.02, margin=1.0)), Fixed(4e-3, steps), 1000)
        assert abs(run.entries["sampling_mass"][-1]) <= 1e-4


@pytest.mark.parametrize("equilibrium", ["cell-average", "sampled"])
def test_what_a_window_cuts_is_the_mass_beyond_it(equilibrium: EquilibriumName) -> None:
    """One step of a flat layer at rest: h (1 - share of the semicircle inside), whatever the equilibrium samples."""
    scene = replace(SCENES["silo"][0], cells=Cells(0, 1, 10), heap=Profile(np.ones(10)), boundary="periodic")
    run = simulate(scene, Kinetic(1, Uniform(64, 0.5, "warn"), equilibrium), Fixed(1e-3, 1), 1)
    a = 0.5 / np.sqrt(0.8)
    share = 2 / np.pi * (a * np.sqrt(1 - a * a) + np.arcsin(a))
    np.testing.assert_allclose(run.entries["window_loss"][-1], 1 - share, rtol=1e-12)


def test_equilibria_that_refill_the_window_refuse_to_leave_anything_out() -> None:
    for name in ("matched", "entropic"):
        with pytest.raises(ValueError, match="puts all of M into the window"):
            Kinetic(velocity=Uniform(16, 1.0, "warn"), equilibrium=name)
