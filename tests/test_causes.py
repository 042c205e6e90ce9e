"""The moment ledger and the kinetic entropy."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from conftest import EPS, SCENES
from covering import covering
from states import incline

from kinsim import (
    Cells,
    Fixed,
    Kinetic,
    Uniform,
    Window,
    simulate,
    step,
)
from kinsim.kinetic.equilibrium import EQUILIBRIA
from kinsim.kinetic.force import FORCES
from kinsim.method import EquilibriumName, ForceName, ProjectionName
from kinsim.solver.solver import Solver

PROJECTIONS: tuple[ProjectionName, ...] = get_args(ProjectionName)

VELOCITIES = {"uniform": Uniform(48), "cut": Uniform(48, 1.25, "warn"), "window": Window(0.08)}

HOUSES = covering(
    VELOCITIES, EQUILIBRIA, FORCES, PROJECTIONS, (1, 3),
    where=lambda velocity, equilibrium, *_: velocity != "cut" or equilibrium in ("cell-average", "sampled"),
)  # fmt: skip
"""The other equilibria refill the window."""


@pytest.mark.parametrize(("velocity", "equilibrium", "force", "projection", "scheme"), HOUSES)
def test_causes_add_up(
    velocity: str,
    equilibrium: EquilibriumName,
    force: ForceName,
    projection: ProjectionName,
    scheme: int,
) -> None:
    """Stage by stage the changes of mass, momentum, energy and entropy add up to the whole."""
    scene = replace(SCENES["silo-incline"][0], cells=Cells(-3, 3, 40))
    run = simulate(
        scene, Kinetic(scheme, VELOCITIES[velocity], equilibrium, force, projection), Fixed(1e-2, 30), 10, causes=True
    )
    causes = run.causes
    gap = (causes["sum"].sum("stage") - causes["total"]).values
    size = np.abs(causes["sum"].values).sum(axis=1).max() + run.entries["mass"][0]
    assert np.abs(gap).max() <= 30 * 16 * EPS * size
    assert causes.sizes == {"t": 4, "stage": 6, "quantity": 4}
    if projection == "flux-difference":
        booked = run.entries["inflow_left"] + run.entries["inflow_right"] + run.entries["coupling_drift"]
        np.testing.assert_allclose(causes["total"].sel(quantity="mass"), booked, atol=1e-13)


@pytest.mark.parametrize("boundary", ["periodic", "wall", "open"])
def test_transport_and_projection_never_raise_the_entropy(boundary: str, rng: np.random.Generator) -> None:
    """Upwind faces, `Entropic`, lam |xi| <= 1 on occupied nodes: Jensen for transport, minimality for projection."""
    for seed in range(4):
        dice = np.random.default_rng(seed)
        h, u = dice.uniform(0.05, 2.0, 40), dice.uniform(-1.0, 1.0, 40)
        scene = replace(incline(h, u, 0.2), boundary=boundary)
        method = Kinetic(1, Uniform(64, 4.0), "entropic")
        solver = Solver(scene, method)
        solver.warm_up()
        dt = 0.999 * scene.cells.dx / solver.counted
        run = simulate(scene, method, Fixed(dt, 1), 1, causes=True)
        last = run.causes["step"].isel(t=-1).sel(quantity="entropy")
        assert last.sel(stage="transport") <= 1e-14
        before = step(scene, method, h, h * u, dt)
        after = step(scene, method, run.h[-1], run.q[-1], dt)

        def entropy(f: np.ndarray, xi: np.ndarray = before.xi, beta: float = scene.beta) -> float:
            return float((xi**2 * f / 2 + (math.pi * beta) ** 2 / 6 * f**3).sum())

        assert entropy(after.M) <= entropy(before.f_force) * (1 + 8 * EPS)
        assert entropy(after.M) < entropy(before.f_force) - 1e-6
