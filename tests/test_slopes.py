"""Families of zeta(x): derivatives, measured chutes, and what is refused."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import kinsim
from kinsim import (
    Arc,
    Bend,
    Bowl,
    Cells,
    ConstantSlope,
    Coulomb,
    Crest,
    Exponential,
    Expression,
    Fixed,
    Inflow,
    InputError,
    Macroscopic,
    Scene,
    SlopeFormula,
    SlopePoints,
    SlopeTable,
    SmoothChute,
)  # fmt: skip

FAMILIES = {
    "bend": Bend(0.6, 0.0, 1.0, 3.0),
    "exponential": Exponential(1.0, 10.0),
    "crest": Crest(0.1, 0.9, 2.0, 0.8),
    "bowl": Bowl(0.9, 2.0, 1.5),
    "arc": Arc(6.0, 0.3, 2.0),
    "hill": Arc(-6.0, 0.0, 2.0),
    "expression": SlopeFormula("0.1 + 0.35*sin(x)"),
    "angles": SlopePoints(tuple(np.linspace(-1, 6, 40)), tuple(0.2 * np.cos(np.linspace(-1, 6, 40)))),
    "elevations": SlopePoints(tuple(np.linspace(-1, 6, 60)), elevation=tuple(0.3 * np.cos(np.linspace(-1, 6, 60)))),
}


@pytest.mark.parametrize("slope", FAMILIES.values(), ids=FAMILIES)
def test_derivative_is_that_of_the_angle(slope: object) -> None:
    """Richardson's extrapolation of central differences, another way than any of the families takes."""
    x = np.linspace(0.3, 3.7, 137)
    halves = [(slope(x + step)[0] - slope(x - step)[0]) / (2.0 * step) for step in (2e-3, 1e-3)]
    rise = (4.0 * halves[1] - halves[0]) / 3.0
    np.testing.assert_allclose(slope(x)[1], rise, rtol=0, atol=3e-7)


def test_families_are_as_steep_as_they_say() -> None:
    """A valley falls towards its place from both sides, a hill away from it; the others between their ends."""
    far = np.array([-40.0, 2.0, 40.0])
    np.testing.assert_allclose(FAMILIES["bowl"](far)[0], [0.9, 0.0, -0.9], atol=1e-15)
    np.testing.assert_allclose(FAMILIES["crest"](far)[0], [0.1, 0.5, 0.9], atol=1e-15)
    near = np.array([1.4, 2.0, 2.6])
    np.testing.assert_allclose(FAMILIES["arc"](near)[0], [0.4, 0.3, 0.2], atol=1e-15)
    np.testing.assert_allclose(FAMILIES["hill"](near)[0], [-0.1, 0.0, 0.1], atol=1e-15)
    np.testing.assert_allclose(FAMILIES["exponential"](np.array([0.0, 10.0]))[0], [1.0, math.exp(-1.0)], atol=1e-15)


def test_bend_begins_and_ends_without_a_kink() -> None:
    zeta, rise = FAMILIES["bend"](np.array([0.0, 1.0, 2.0, 3.0, 4.0]))
    np.testing.assert_allclose(zeta, [0.6, 0.6, 0.3, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(rise[[0, 1, 3, 4]], 0.0, atol=1e-15)


def test_measured_elevations_of_an_arc() -> None:
    """Points on a circle: the angle falls with the length along it, as `Arc` says."""
    radius, at = 5.0, np.linspace(-0.9, 0.9, 80)
    measured = SlopePoints(tuple(radius * np.sin(at)), elevation=tuple(-radius * np.cos(at)))
    x = radius * np.sin(-0.9) + radius * np.linspace(0.2, 1.6, 50)  # along the arc from its first point
    zeta, rise = measured(x)
    np.testing.assert_allclose(zeta, 0.9 - np.linspace(0.2, 1.6, 50), atol=2e-6)
    np.testing.assert_allclose(rise, -1.0 / radius, atol=2e-5)


def test_table_of_a_file_is_that_of_its_points(tmp_path: Path) -> None:
    x = np.linspace(0.0, 4.0, 20)
    rows = "\n".join(f"{a},{b}" for a, b in zip(x, 0.1 * x, strict=True))
    (tmp_path / "bed.csv").write_text(f"x,zeta\n{rows}\n")
    (tmp_path / "scene.toml").write_text(
        '[chute]\nkind = "smooth"\nzeta = {kind = "table", path = "bed.csv", smoothing = 0.01}\n'
        "[cells]\nleft = 0\nright = 4\ncount = 40\n"
        '[heap]\nkind = "expression"\nh = "1"\n[clock]\ndt = 0.001\nsteps = 3\n'
    )
    scene, _, _ = kinsim.load_scene(tmp_path / "scene.toml")
    assert scene.chute.zeta == SlopeTable(tmp_path / "bed.csv", 0.01)
    for one, other in zip(scene.chute.zeta(x), SlopePoints(tuple(x), tuple(0.1 * x), smoothing=0.01)(x), strict=True):
        assert np.array_equal(one, other)
    np.testing.assert_allclose(scene.chute.zeta(x)[1], 0.1, atol=1e-6)


def scene(zeta: object, **keys: object) -> Scene:
    return Scene(Cells(0.0, 4.0, 40), Expression("1"), SmoothChute(zeta, 1.0), Coulomb(0.4), **keys)


def test_bad_chutes_get_one_line() -> None:
    def says(*words: str) -> object:
        return pytest.raises(InputError, match=".*".join(words))

    with says("zeta is 1.4", "x = 1.4", "80 degrees"):
        scene(SlopeFormula("x"))
    with says("zeta is 0", "0.4", "periodic"):
        scene(SlopeFormula("0.1*x"), boundary="periodic")
    with says("start = 3", "below end = 1"):
        Bend(0.1, 0.2, 3.0, 1.0)
    with says("radius = 0"):
        Arc(0.0)
    with says("zeta or elevation"):
        SlopePoints((0.0, 1.0))
    with says("six or more"):
        SlopePoints((0.0, 1.0), (0.1, 0.2))
    with says("x must increase"):
        SlopePoints((0.0, 1.0, 1.0, 2.0, 3.0, 4.0), (0.0,) * 6)
    with says("chute", "zeta is nan"):
        scene(SlopePoints((0.0, 1e-300, 2e-300, 3.0, 4.0, 5.0), (0.0,) * 6))
    with says("smoothing", "1000"):
        SlopePoints((0.0, 1.0, 2.0, 3.0, 4.0, 5.0), (0.0,) * 6, smoothing=1e300)
    with says("h", "greater than or equal to 0|at least 0"):
        scene(Arc(9.0), boundary=({"h": -1, "u": 2}, "open"))
    with says("scheme 3", "constant slope", "scheme 4"):
        kinsim.simulate(scene(Arc(9.0)), Macroscopic(3), Fixed(1e-3, 2))


@pytest.mark.parametrize("scheme", [1, 3, 4])
def test_stream_enters_a_constant_slope(scheme: int) -> None:
    """Faster than its waves, all of it comes in: h u dt in each step; balanced faces of scheme 2 take a mean."""
    made = Scene(
        Cells(0.0, 4.0, 40), Expression("0.2", "3"), ConstantSlope(0.3), Coulomb(0.3), (Inflow(0.5, 3.0), "open"), 0.4
    )
    run = kinsim.simulate(made, Macroscopic(scheme), Fixed(0.005, 100))
    assert run.entries["inflow_left"][-1] == pytest.approx(0.5 * 3.0 * 0.5, rel=1e-13)
    assert abs(run.mass_drift) <= 1e-13 or scheme == 3
    assert run.h[-1, 0] == pytest.approx(0.5, abs=0.02)


def test_kinetic_stream_enters() -> None:
    made = Scene(
        Cells(0.0, 4.0, 40), Expression("0.2", "3"), ConstantSlope(0.3), Coulomb(0.3), (Inflow(0.5, 3.0), "open"), 0.4
    )
    clock = Fixed(0.005, 100)
    closed = kinsim.simulate(made, Macroscopic(), clock)
    for method in (kinsim.Kinetic(velocity=kinsim.Uniform(64)), kinsim.Kinetic(velocity=kinsim.Fitted(6))):
        run = kinsim.simulate(made, method, clock)
        np.testing.assert_allclose(run.h[-1], closed.h[-1], atol=5e-4)


def test_angle_of_a_friction_law_and_its_scene_agree() -> None:
    made = scene(Arc(9.0, 0.1, 2.0))
    np.testing.assert_allclose(made.resistance, np.cos(made.chute.zeta(made.x)[0]) * math.tan(0.4), rtol=1e-15)
    np.testing.assert_allclose(made.beta, np.cos(made.chute.zeta(made.x)[0]), rtol=1e-15)
