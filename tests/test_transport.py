"""Transport: f_i = M_i - lam xi (M_{i+1/2} - M_{i-1/2})."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from states import BETA, ghosted, random_states, scene_with

from kinsim import Kinetic, Profile, Scene, Uniform, step
from kinsim.solver.step import Step

EPS = float(np.finfo(float).eps)
EQUILIBRIA = ["cell-average", "sampled"]


@pytest.mark.parametrize("equilibrium", EQUILIBRIA)
@pytest.mark.parametrize("boundary", ["periodic", "wall", "open", ("wall", "open")])
def test_density_is_taken_from_upwind(equilibrium: str, boundary: str, rng: np.random.Generator) -> None:
    """(19) and (23) before the shift, recomputed."""
    h, u = random_states(rng, 60)
    scene = scene_with(h, u, boundary=boundary)
    method = Kinetic(1, Uniform(32, 2.0), equilibrium)
    now = step(scene, method, h, h * u, dt := 0.02)
    lam = dt / scene.cells.dx
    kinds = boundary if isinstance(boundary, tuple) else (boundary,) * 2
    ends = [{"open": here, "wall": here[::-1], "periodic": there}[kind] for kind, here, there in (
        (kinds[0], now.M[0], now.M[-1]), (kinds[1], now.M[-1], now.M[0]))]  # fmt: skip
    M = np.vstack([ends[0], now.M, ends[1]])
    at_face = np.where(now.xi > 0, M[:-1], M[1:])
    expected = now.M - lam * now.xi * (at_face[1:] - at_face[:-1])
    np.testing.assert_allclose(now.f_transport, expected, atol=4 * EPS * M.max())


@pytest.mark.parametrize("equilibrium", EQUILIBRIA)
def test_fluxes_are_half_range_sums(equilibrium: str, rng: np.random.Generator) -> None:
    """F = sum xi (1, xi) M w; over cell averages xi^2 weighs dxi^2/12 less."""
    h, u = random_states(rng, 60)
    now = step(scene_with(h, u), Kinetic(1, Uniform(32, 2.0), equilibrium), h, h * u, 0.01)
    dxi = now.xi[1] - now.xi[0]
    M = ghosted(scene_with(h, u), now.M)
    at_face = np.where(now.xi > 0, M[:-1], M[1:])
    second = now.xi**2 - (dxi**2 / 12 if equilibrium == "cell-average" else 0)
    np.testing.assert_allclose(now.flux, [dxi * at_face @ now.xi, dxi * at_face @ second], atol=64 * EPS)


@pytest.mark.parametrize("equilibrium", EQUILIBRIA)
@pytest.mark.parametrize("courant", [1.0, 0.999, 0.5, 0.02])
def test_density_stays_nonnegative_under_the_cfl_bound(
    equilibrium: str, courant: float, rng: np.random.Generator
) -> None:
    """Exactly, rounding included, up to Courant number 1 of the outermost node."""
    h, u = random_states(rng, 3000, decades=12)
    scene = scene_with(h, u, zeta=0.3, delta=0.2)
    now = step(scene, Kinetic(1, Uniform(48, 2.2), equilibrium), h, h * u, courant * scene.cells.dx / 2.2)
    assert (now.f_transport >= 0).all()
    assert (now.f_force >= 0).all()
    assert (now.h1 >= -4 * EPS).all()


def test_density_goes_negative_beyond_the_cfl_bound() -> None:
    """The bound is sharp: a cell with empty neighbours sends out more than it has."""
    h = np.array([0.0, 1.0, 0.0])
    scene = scene_with(h)
    top = np.sqrt(2 * BETA)
    method = Kinetic(1, Uniform(32, top))
    assert (step(scene, method, h, 0 * h, 0.99 * scene.cells.dx / top).f_transport >= 0).all()
    assert (step(scene, method, h, 0 * h, 1.1 * scene.cells.dx / top).f_transport < 0).any()


@pytest.mark.parametrize("equilibrium", EQUILIBRIA)
def test_transport_keeps_mass_and_momentum_of_f(equilibrium: str, rng: np.random.Generator) -> None:
    """Over a period, to the rounding of the sum."""
    h, u = random_states(rng, 100)
    now = step(scene_with(h, u), Kinetic(1, Uniform(32, 2.0), equilibrium), h, h * u, 0.01)
    for weight in (np.ones(32), now.xi):
        before, after = np.sum(now.M @ weight), np.sum(now.f_transport @ weight)
        assert after == pytest.approx(before, abs=100 * 32 * EPS * now.M.max())


def test_one_cell_is_crossed_at_courant_number_one() -> None:
    """xi dt = dx: f_i is exactly what stood in the cell upwind."""
    h = np.array([0.3, 1.0, 0.4, 0.7])
    scene = scene_with(h)
    method = Kinetic(1, Uniform(4, 2.0))  # nodes -1.5, -0.5, 0.5, 1.5
    now = step(scene, method, h, 0.2 * h, scene.cells.dx / 0.5)
    np.testing.assert_allclose(now.f_transport[:, 2], np.roll(now.M[:, 2], 1), rtol=4 * EPS)
    np.testing.assert_allclose(now.f_transport[:, 1], np.roll(now.M[:, 1], -1), rtol=4 * EPS)


@pytest.mark.parametrize("scheme", [1, 2, 3])
@pytest.mark.parametrize("equilibrium", EQUILIBRIA)
def test_f_differs_from_the_state_by_the_sampling_defect_alone(
    scheme: int, equilibrium: str, rng: np.random.Generator
) -> None:
    """Sums of f, against U^{n+1}, hold what the grid makes of M, and nothing else.

    With S_k = sum dxi xi^k over the nodes:
      mass:      S_0 f - h1 = S_0 M - h, which is 0 for cell averages;
      momentum:  S_1 f - q1 = (S_1 M - q) - lam w [S_0 of the faces, right less left] + J (S_0 f / h1 - 1),
    w = dxi^2/12 for cell averages, whose flux weighs xi^2 - w where transport weighs xi^2, and 0 when sampled.
    """
    h, u = random_states(rng, 80, decades=0.5)
    h = np.maximum(h, 0.1)  # wet, so that no cell falls below 0 with schemes 2 and 3
    u[::5] *= 1e-3  # some cells are slow
    scene = scene_with(h, u, zeta=0.1, delta=0.3)
    dt = 0.004
    coupling = "face" if scheme == 3 else "cell"
    method = Kinetic(scheme, Uniform(64, 2.5), equilibrium, coupling=coupling)
    now = step(scene, method, h, h * u, dt)
    dxi = now.xi[1] - now.xi[0]
    lam = dt / scene.cells.dx
    M = ghosted(scene, now.M)
    at_face = np.where(now.xi > 0, M[:-1], M[1:])
    if scheme > 1:
        slow = ghosted(scene, now.slow)
        balanced = np.ones(81, bool) if scheme == 2 else slow[:-1] & slow[1:]
        assert balanced.any()
        at_face[balanced] = face_density(scene, method, now)[balanced]
    missing = dxi**2 / 12 if equilibrium == "cell-average" else 0.0
    defect = -lam * missing * np.diff(dxi * at_face.sum(axis=1))
    mass, momentum = dxi * now.f_force.sum(axis=1), dxi * now.f_force @ now.xi
    np.testing.assert_allclose(mass - now.h1, dxi * now.M.sum(axis=1) - h, atol=64 * EPS)
    pushed = now.impulse * (mass / now.h1 - 1)
    np.testing.assert_allclose(momentum - now.q1, dxi * now.M @ now.xi - h * u + defect + pushed, atol=128 * EPS)


def face_density(scene: Scene, method: Kinetic, now: Step) -> np.ndarray:
    """The density at balanced faces, (25), as the rows M of cells that hold the face states."""
    at = now.balanced
    assert at is not None
    cells = replace(scene.cells, count=at.h_left.size)
    faces = replace(scene, cells=cells, heap=Profile(h=at.h_left))
    left, right = (
        step(faces, replace(method, scheme=1, coupling="cell"), h, h * u, 1e-9).M
        for h, u in ((at.h_left, at.u_left), (at.h_right, at.u_right))
    )
    return np.where(now.xi > 0, left, right)
