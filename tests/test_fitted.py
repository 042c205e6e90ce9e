"""Velocity nodes fitted to each cell."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import EPS, SCENES
from states import BETA

from kinsim import (
    Fitted,
    Fixed,
    Kinetic,
    Macroscopic,
    simulate,
)
from kinsim.kinetic.gauss_jacobi import gauss_jacobi, measure
from kinsim.macroscopic.closed_form import half_moments_closed, half_moments_of_cells


def moments(h: np.ndarray, u: np.ndarray) -> np.ndarray:
    return np.array([h, h * u, h * u * u + 0.5 * BETA * h * h])


def all_regimes(rng: np.random.Generator, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Random states, a third supersonic, a third just around |u| = c, a tenth at rest."""
    h = 10.0 ** rng.uniform(-6, 3, count)
    near = 1.0 + rng.choice([-1, 1], count) * 10.0 ** rng.uniform(-12, 0, count)
    a = np.where(rng.random(count) < 0.33, near, rng.uniform(-1.5, 1.5, count)) * rng.choice([-1, 1], count)
    a[::10] = 0.0
    return h, a * np.sqrt(2 * BETA * h)


@pytest.mark.parametrize(("count", "reach"), [(3, 1e-6), (5, 1e-10), (6, 1e-12), (8, 2e-15)])
def test_fitted_nodes_reach_the_closed_form(count: int, reach: float, rng: np.random.Generator) -> None:
    """10^5 random states in all regimes, on the flux scale h (|u| + c)^k; both sides add up to the total."""
    h, u = all_regimes(rng, 100_000)
    fitted = np.empty((4, h.size))
    half_moments_of_cells(gauss_jacobi(count), h, u, np.full(h.size, BETA), fitted)
    closed = np.array([half_moments_closed(a, b, BETA) for a, b in zip(h, u, strict=True)]).T
    speed = np.abs(u) + np.sqrt(2 * BETA * h)
    scale = h * np.array([speed, speed**2, speed, speed**2])
    assert (np.abs(fitted - closed) / scale).max() <= reach
    total = moments(h, u)
    assert (np.abs(fitted[0] + fitted[2] - total[1]) / scale[0]).max() <= 2 * EPS
    assert (np.abs(fitted[1] + fitted[3] - total[2]) / scale[1]).max() <= 2 * EPS


def test_fitted_measure_carries_the_small_side(rng: np.random.Generator) -> None:
    """Nodes lie on the side that holds less, masses are positive, and their first two moments are the half moments."""
    h, u = all_regimes(rng, 300)
    nodes, masses = measure(8, h, u, BETA)
    assert (masses >= 0).all()
    assert (nodes * np.where(u == 0, -1.0, u)[:, None] <= 0).all()
    closed = np.array([half_moments_closed(a, b, BETA) for a, b in zip(h, u, strict=True)])
    small = np.where((u > 0)[:, None], closed[:, 2:], closed[:, :2])
    speed = np.abs(u) + np.sqrt(2 * BETA * h)
    for k in (1, 2):
        assert (np.abs((masses * nodes**k).sum(axis=1) - small[:, k - 1]) / (h * speed**k)).max() <= 4e-15


@pytest.mark.parametrize("name", SCENES)
def test_fitted_runs_follow_the_closed_form(name: str) -> None:
    """All five scenes, a thousand steps: the difference falls to rounding with the nodes, and mass is kept.

    In `sine` scheme 3 chatters, whatever computes its fluxes; there scheme 1 runs.
    """
    scene, _ = SCENES[name]
    scheme = 1 if name == "sine" else 3
    coupling = "face" if scheme == 3 else "cell"
    closed = simulate(scene, Macroscopic(scheme, coupling), Fixed(1e-3, 1000), 1000)
    off = []
    for count in (3, 5, 8):
        run = simulate(scene, Kinetic(scheme, Fitted(count), coupling=coupling), Fixed(1e-3, 1000), 1000)
        off.append(float(np.abs(run.h[-1] - closed.h[-1]).max()))
        assert abs(run.mass_drift) <= 1e-14
    assert off[0] <= 1e-5
    assert off[1] <= 1e-9
    assert off[2] <= 1e-12
