"""Velocity cells that are too wide for M are told, with the number to take."""

from __future__ import annotations

import re

import numpy as np
import pytest
from conftest import SCENES

from kinsim import Fixed, Kinetic, Uniform, Window, simulate
from kinsim.diagnostics.resolution import unresolved


@pytest.mark.parametrize("cells", [Uniform(8, 3.0), Window(32.0), Window(0.5)], ids=["8 cells", "dxi 32", "dxi 0.5"])
def test_the_number_that_is_told_is_enough(cells: Uniform | Window) -> None:
    """A window of 32 meant as a count loses all mass; what is asked for in its place resolves M."""
    scene = SCENES["silo"][0]
    run = simulate(scene, Kinetic(1, cells), Fixed(1e-3, 5))
    assert "velocity cells" in str(run.verdict)
    number = float(re.search(r"take (?:dxi <= )?([\d.e-]+)", str(run.verdict))[1])
    finer = Window(number) if isinstance(cells, Window) else Uniform(int(number), 3.0)
    assert "velocity cells" not in str(simulate(scene, Kinetic(1, finer), Fixed(1e-3, 5)).verdict)


def test_thin_layers_count_by_their_mass() -> None:
    """A film that holds less than a hundredth of the mass need not be resolved; half of the mass must be."""
    film = np.where(np.arange(100) < 50, 1.0, 1e-6)
    assert unresolved(Window(0.1), 0.0, 0.5, film) == ""
    layer = np.where(np.arange(100) < 5, 1.0, 0.005)
    assert "in thin layers" in unresolved(Window(0.1), 0.0, 0.5, layer)
    assert unresolved(None, 0.0, 0.5, layer) == unresolved(Window(9.0), 0.0, 0.5, np.zeros(3)) == ""
