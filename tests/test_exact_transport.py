"""Collisionless transport of f under a constant force, by its residual and by the rooms that approach it."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from states import push_each, upwind

from kinsim import Cells, InputError
from kinsim.exact import FreeTransport
from kinsim.kinetic.force import FORCES

EPS = float(np.finfo(float).eps)
G = 0.7


def cloud(x: np.ndarray, xi: np.ndarray) -> np.ndarray:
    """A smooth cloud that leans and is centred nowhere special."""
    return np.exp(-2 * (x - 0.3) ** 2 - 3 * (xi + 0.2) ** 2 + x * xi)


@pytest.mark.parametrize("g", [G, 0.0, -1.1])
def test_solves_the_equation(g: float, rng: np.random.Generator) -> None:
    """f_t + xi f_x + g f_xi = 0 with complex steps, free of cancellation; the code is this formula."""
    free, step = FreeTransport(cloud, g), 1e-200

    def formula(x: complex, xi: complex, t: complex) -> complex:
        return cloud(x - xi * t + g * t * t / 2, xi - g * t)

    for x, xi, t in zip(*rng.uniform(-1, 1, (2, 20)), rng.uniform(0, 2, 20), strict=True):
        f_x, f_xi, f_t = (
            formula(x + dx * step * 1j, xi + dxi * step * 1j, t + dt * step * 1j).imag / step
            for dx, dxi, dt in ((1, 0, 0), (0, 1, 0), (0, 0, 1))
        )
        assert f_t + xi * f_x + g * f_xi == pytest.approx(0.0, abs=64 * EPS * (abs(f_t) + abs(f_x) + abs(f_xi)))
        assert free(x, xi, t) == pytest.approx(formula(x, xi, t), rel=64 * EPS)


def test_density_travels_with_the_particles(rng: np.random.Generator) -> None:
    """Particles integrated step by step with Stoermer and Verlet, which is exact for a constant force."""
    free = FreeTransport(cloud, G)
    x, xi = rng.normal(size=(2, 50))
    carried, t, dt = cloud(x, xi), 0.0, 0.05
    for _ in range(40):
        xi = xi + dt * G / 2
        x = x + dt * xi
        xi = xi + dt * G / 2
        t += dt
    np.testing.assert_allclose(free(x, xi, t), carried, rtol=1e-11)


def test_later_continues_earlier() -> None:
    first = FreeTransport(cloud, G)
    second = FreeTransport(lambda x, xi: first(x, xi, 0.7), G)
    x, xi = np.linspace(-2, 4, 31), np.linspace(-1, 2, 17)[:, None]
    assert first(x, xi, 0.0).shape == (17, 31)
    np.testing.assert_array_equal(first(x, xi, 0.0), cloud(x, xi))
    np.testing.assert_allclose(second(x, xi, 0.6), first(x, xi, 1.3), rtol=1e-13)


def test_mirror_image() -> None:
    mirrored = FreeTransport(lambda x, xi: cloud(-x, -xi), -G)
    x, xi = np.linspace(-2, 4, 31), np.linspace(-1, 2, 17)[:, None]
    np.testing.assert_array_equal(FreeTransport(cloud, G)(x, xi, 1.1), mirrored(-x, -xi, 1.1))


def test_books() -> None:
    """Mass stays, momentum grows by g t times the mass, energy int f (xi^2/2 - g x) stays; averages are what is summed.

    The window holds the cloud to 1e-16; the midpoint rule is spectrally exact for it.
    """
    free, cells, xi = FreeTransport(cloud, G), Cells(-16, 20, 180), np.linspace(-8, 9, 171)
    dxi = xi[1] - xi[0]
    middle = 0.5 * (xi[1:] + xi[:-1])

    def books(t: float) -> list[float]:
        f = free(cells.x[:, None], middle, t) * cells.dx * dxi
        return [f.sum(), (f * middle).sum(), (f * (middle**2 / 2 - G * cells.x[:, None])).sum()]

    mass, momentum, energy = books(0.0)
    assert books(1.5) == pytest.approx([mass, momentum + 1.5 * G * mass, energy], rel=1e-12)
    assert (free.averages(cells, xi, 1.5) * cells.dx * dxi).sum() == pytest.approx(mass, rel=1e-12)


def test_averages_of_polynomials_are_exact() -> None:
    """f0 = x^3 + x xi + xi^2 at t = 1/2, g = 2, by its antiderivative: degree 3 per direction needs two points."""
    free = FreeTransport(lambda x, xi: x**3 + x * xi + xi**2, 2.0, points=2)
    cells, xi, t = Cells(-1, 2, 3), np.array([-1.0, -0.25, 0.5]), 0.5

    def cube(x: float, xi: float) -> float:
        """Integral over x and xi of (x - xi t + t^2)^3 + (x - xi t + t^2)(xi - 2 t) + (xi - 2 t)^2."""
        y, v = x - xi * t + t * t, xi - 2 * t  # x = y + xi t - t^2
        third = -(y**5) / (20 * t)  # d2/dx dxi of it is y^3
        product = x * v**3 / 3 + (x * x / 2 - x * t * t) * v * v / 2 - t * x * v**3 / 3
        return third + product

    corner = np.array([[cube(x, v) for v in xi] for x in (-1.0, 0.0, 1.0, 2.0)])
    expected = (corner[1:, 1:] - corner[1:, :-1] - corner[:-1, 1:] + corner[:-1, :-1]) / 0.75
    np.testing.assert_allclose(free.averages(cells, xi, t), expected, rtol=1e-13, atol=1e-14)


def rooms(count: int, g: float) -> float:
    """L1 error of upwind transport and linear shift in turn, without projection, at t = 0.5, Courant number 0.8."""
    cells, xi, end = Cells(-4, 5, count), np.linspace(-3, 3, 2 * count // 3 + 1), 0.5
    dxi, middle = xi[1] - xi[0], 0.5 * (xi[1:] + xi[:-1])
    steps = math.ceil(end * 3 / (0.8 * cells.dx))
    dt = end / steps
    free = FreeTransport(cloud, g, points=4)
    f, J, one = free.averages(cells, xi, 0.0), np.full(count, g * dt), np.ones(count)
    for _ in range(steps):
        moved = upwind(f, middle, dt / cells.dx)
        push_each(FORCES["shift-linear"], moved, moved, J, one, dxi, f, np.zeros(count))
    return float(np.abs(f - free.averages(cells, xi, end)).sum() * cells.dx * dxi)


@pytest.mark.parametrize("g", [0.0, G, -G])
def test_rooms_approach_it_at_first_order(g: float) -> None:
    """Both are of first order: halving all widths halves the error, up to the next order, a tenth of it here."""
    errors = [rooms(count, g) for count in (90, 180, 360)]
    assert errors[-1] < 0.04 * 1.3  # of a mass of about 1.3
    for coarse, fine in itertools.pairwise(errors):
        assert 1.7 < coarse / fine < 2.1


def test_questions_and_data_outside() -> None:
    free = FreeTransport(cloud, G)
    for t in (-1e-9, math.nan, math.inf):
        with pytest.raises(InputError, match="0 <= t"):
            free(0.0, 0.0, t)
    for x, xi in ((math.nan, 0.0), (0.0, math.nan)):
        with pytest.raises(InputError, match="not a number"):
            free(x, xi, 1.0)
    for edges in ([0.0], [0.0, 0.0], [1.0, 0.0], [[0.0, 1.0]]):
        with pytest.raises(InputError, match="do not increase"):
            free.averages(Cells(-1, 1, 2), edges, 1.0)
    with pytest.raises(InputError, match="f0"):
        FreeTransport(1.0)
    with pytest.raises(InputError, match="points"):
        FreeTransport(cloud, points=0)
