"""The force step: f(xi + J/h^{n+1}) <- f(xi) as a conservative linear remap."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from states import push_each

from kinsim.kinetic.force import FORCES, moved

EPS = float(np.finfo(float).eps)
N, DXI = 200, 0.03
XI = (np.arange(N) - N / 2 + 0.5) * DXI


def shift(f: np.ndarray, distance: np.ndarray | float, dxi: float = DXI) -> tuple[np.ndarray, float]:
    """Each row moved by `distance`; with h1 = 0.5 to see that J is divided by it."""
    f = np.ascontiguousarray(np.atleast_2d(f))
    out, offset = np.full_like(f, np.nan), np.full(len(f), np.nan)
    h1 = np.full(len(f), 0.5)
    lost = push_each(FORCES["shift-linear"], f, f, np.broadcast_to(distance, len(f)) * h1, h1, dxi, out, offset)
    assert (offset == 0.0).all()
    return out, lost


def bump(rng: np.random.Generator, rows: int = 1, width: int = 20) -> np.ndarray:
    f = np.zeros((rows, N))
    f[:, N // 2 - width : N // 2 + width] = rng.uniform(0, 1, (rows, 2 * width))
    return f


@given(st.floats(-2.3, 2.3))
def test_shift_is_exact_in_mass_and_momentum(distance: float) -> None:
    """Any size and sign inside the window: m0 stays, m1 grows by distance m0; to the rounding of the sums."""
    f = bump(np.random.default_rng(1))
    out, lost = shift(f, distance)
    m0 = f.sum() * DXI
    assert lost == 0.0
    assert out.sum() * DXI == pytest.approx(m0, rel=8 * EPS)
    assert (out @ XI)[0] * DXI == pytest.approx((f @ XI)[0] * DXI + distance * m0, abs=32 * EPS * m0 * 3)


@given(st.floats(-2.3, 2.3))
def test_second_moment_error_is_theta_one_minus_theta(distance: float) -> None:
    """m2 = exact + theta (1 - theta) dxi^2 m0, theta the fraction of a cell."""
    f = bump(np.random.default_rng(2))
    out, _ = shift(f, distance)
    m0, m1, m2 = (f @ XI**k * DXI for k in range(3))
    theta = abs(distance) / DXI % 1
    exact = m2 + 2 * distance * m1 + distance**2 * m0
    assert out @ XI**2 * DXI == pytest.approx(exact + theta * (1 - theta) * DXI**2 * m0, rel=32 * EPS, abs=1e-14)


@given(st.floats(-20, 20), st.integers(0, 2**32 - 1))
def test_what_leaves_the_window_is_booked(distance: float, seed: int) -> None:
    """Mass before = mass after + loss, for shifts up to and beyond the whole window."""
    f = np.random.default_rng(seed).uniform(0, 1, (3, N))
    out, lost = shift(f, distance)
    assert out.sum() * DXI + lost == pytest.approx(f.sum() * DXI, rel=N * EPS)
    assert (out >= 0).all()
    if abs(distance) > (N + 1) * DXI:
        assert (out == 0).all()


@pytest.mark.parametrize("cells", [0, 1, 7, -1, -30])
def test_whole_cells_move_bit_for_bit(cells: int, rng: np.random.Generator) -> None:
    f = bump(rng, rows=2)
    out, lost = shift(f, cells * 0.25, dxi=0.25)  # a power of two: the distance is whole cells exactly
    np.testing.assert_array_equal(out, np.roll(f, cells, axis=1))
    assert lost == 0.0


def test_shifted_mirror_image_is_the_mirror_image_bit_for_bit(rng: np.random.Generator) -> None:
    f = rng.uniform(0, 1, (50, N))
    distance = rng.normal(size=50)
    one, lost = shift(f, distance)
    other, lost_too = shift(f[:, ::-1].copy(), -distance)
    np.testing.assert_array_equal(one, other[:, ::-1])
    assert lost == lost_too


def test_rows_are_shifted_each_by_its_own_impulse(rng: np.random.Generator) -> None:
    f = bump(rng, rows=3)
    out, _ = shift(f, np.array([0.0, 0.5, -1.1]))
    for i, distance in enumerate((0.0, 0.5, -1.1)):
        np.testing.assert_array_equal(out[i], shift(f[i], distance)[0][0])
    np.testing.assert_array_equal(moved(f, np.array([0.0, 0.5, -1.1]), DXI), out)


def test_two_shifts_and_back_do_not_sharpen(rng: np.random.Generator) -> None:
    """A remap averages: no new extremes."""
    f = bump(rng)
    out, _ = shift(shift(f, 0.4 * DXI)[0], -0.4 * DXI)
    assert out.max() <= f.max() * (1 + 4 * EPS)


def test_dry_rows_are_left_alone() -> None:
    """No mass, nothing to push: no division by zero, whatever the impulse."""
    for force in FORCES.values():
        f, out, offset = np.zeros((2, 8)), np.full((2, 8), np.nan), np.full(2, np.nan)
        assert push_each(force, f, f, np.array([0.3, -0.3]), np.array([0.0, -1e-20]), 0.1, out, offset) == 0.0
        assert (out == 0).all()
        assert (offset == 0).all()
