"""Laws, fluxes and observers that stand in a file of somebody else's."""

from __future__ import annotations

import importlib
import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest
from covering import covering
from states import scene_with

from kinsim import ConstantSlope, Coulomb, Fixed, InputError, Macroscopic, Profile, Run, Scene, simulate

FILE = '''
import math
from typing import NamedTuple

import numpy as np

from kinsim import Coulomb
from kinsim.macroscopic.closed_form import half_moments_closed


class Viscous(NamedTuple):
    """Coulomb friction, and more of it the faster a layer is."""

    mu: float
    nu: float

    def resistance(law, h, v, n):
        return law.mu * n + law.nu * v


class Wet(Coulomb):
    """Another law by name only."""


MORE = 0.0


class Global(NamedTuple):
    """Reads a value of its module."""

    mu: float

    def resistance(law, h, v, n):
        return (law.mu + MORE) * n


def closed(h_left, u_left, h_right, u_right, beta):
    p1, p2, _, _ = half_moments_closed(h_left, u_left, beta)
    _, _, n1, n2 = half_moments_closed(h_right, u_right, beta)
    return p1 + n1, p2 + n2


def hll(h_left, u_left, h_right, u_right, beta):
    c_left, c_right = math.sqrt(beta * h_left), math.sqrt(beta * h_right)
    low = min(u_left - c_left, u_right - c_right, 0.0)
    high = max(u_left + c_left, u_right + c_right, 0.0)
    if high - low <= 0.0:
        return 0.0, 0.0
    q_left, q_right = h_left * u_left, h_right * u_right
    f_left = q_left * u_left + 0.5 * beta * h_left * h_left
    f_right = q_right * u_right + 0.5 * beta * h_right * h_right
    first = (high * q_left - low * q_right + low * high * (h_right - h_left)) / (high - low)
    second = (high * f_left - low * f_right + low * high * (q_right - q_left)) / (high - low)
    return first, second


def _ahead(h, u, beta):
    """The integrals over xi > 0 with xi = u + c sin t."""
    m1, m2 = np.zeros(h.shape), np.zeros(h.shape)
    wet = h > 0.0
    h, u, c = h[wet], u[wet], np.sqrt(2.0 * beta[wet] * h[wet])
    t = np.arcsin(np.clip(-u / c, -1.0, 1.0))
    p0 = 0.5 * (0.5 * np.pi - t - np.sin(t) * np.cos(t))
    p1 = np.cos(t) ** 3 / 3.0
    p2 = (0.5 * np.pi - t) / 8.0 + np.sin(4.0 * t) / 32.0
    m1[wet] = 2.0 * h / np.pi * (u * p0 + c * p1)
    m2[wet] = 2.0 * h / np.pi * (u * u * p0 + 2.0 * u * c * p1 + c * c * p2)
    return m1, m2


def masked(h_left, u_left, h_right, u_right, beta):
    p1, p2 = _ahead(h_left, u_left, beta)
    n1, n2 = _ahead(h_right, -u_right, beta)
    return p1 - n1, p2 + n2


class Heaviest:
    """The greatest height, every fifth step; ends the run at a given one."""

    every = 5
    name = "heaviest"

    def __init__(self, last=10**9):
        self.last, self.noted = last, []

    def look(self, block):
        self.noted.append((block.step, block.t, float(block.h.max())))
        return "seen enough" if block.step >= self.last else None

    def result(self):
        return self.noted
'''


@pytest.fixture(scope="module")
def mine(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """The file, imported as any module of the user's."""
    folder = tmp_path_factory.mktemp("outside")
    (folder / "written_outside.py").write_text(FILE)
    sys.path.insert(0, str(folder))
    yield importlib.import_module("written_outside")
    sys.path.remove(str(folder))
    del sys.modules["written_outside"]


def wet(**more: object) -> Scene:
    """A wave over a deep layer that flows down a slope: fast enough that no face is still."""
    x = (np.arange(40) + 0.5) / 40
    h, u = 1.0 + 0.3 * np.sin(2 * np.pi * x), 0.5 + 0.2 * np.cos(2 * np.pi * x)
    return scene_with(h, u, zeta=0.5, delta=0.2, dx=0.025, **more)  # type: ignore[arg-type]


def ends_dry(**more: object) -> Scene:
    """A mass between dry ends."""
    x = (np.arange(40) + 0.5) / 40
    return scene_with(np.where(np.abs(x - 0.5) < 0.2, 1.0, 0.0), zeta=0.3, delta=0.4, dx=0.025, **more)  # type: ignore[arg-type]


def mass(run: object) -> np.ndarray:
    return np.array([math.fsum(h) for h in run.h])  # type: ignore[attr-defined]


# ---- friction --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scheme", [1, 4])
def test_a_law_that_grows_with_the_speed_brakes_to_the_speed_it_says(mine: ModuleType, scheme: int) -> None:
    """A uniform layer tends to u with sin zeta = mu cos zeta + nu u: explicit steps in scheme 1, implicit in 4."""
    mu, nu, zeta, dt = 0.2, 0.5, 0.5, 4e-3
    scene = replace(scene_with(np.ones(6), zeta=zeta, delta=0.2), friction=mine.Viscous(mu, nu))
    run = simulate(scene, Macroscopic(scheme), Fixed(dt, 200), 1)
    u = np.zeros(201)
    for n in range(200):
        pulled = u[n] + dt * (math.sin(zeta) - mu * math.cos(zeta))
        u[n + 1] = pulled - dt * nu * u[n] if scheme == 1 else pulled / (1.0 + dt * nu)
    np.testing.assert_allclose(run.u, np.repeat(u[:, None], 6, axis=1), rtol=1e-12)
    np.testing.assert_array_equal(run.h, 1.0)


def test_a_law_of_ones_own_that_is_coulombs_gives_coulombs_run(mine: ModuleType) -> None:
    """To rounding, where ends are dry and parts rest; mass stays."""
    scene = ends_dry(boundary="wall")
    own = replace(scene, friction=mine.Viscous(math.tan(0.4), 0.0))
    runs = [simulate(given, Macroscopic(4), Fixed(4e-3, 150)) for given in (scene, own)]
    np.testing.assert_allclose(runs[1].h[-1], runs[0].h[-1], atol=1e-12)
    np.testing.assert_allclose(mass(runs[1]), mass(runs[1])[0], rtol=1e-14)


# ---- fluxes ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "scheme", "boundary"), covering(["closed", "masked"], [1, 4], ["periodic", "wall"]))
def test_the_same_formula_gives_the_same_run(mine: ModuleType, name: str, scheme: int, boundary: str) -> None:
    """Whether it is compiled, or array code that is called back."""
    built_in, own = (
        simulate(wet(boundary=boundary), Macroscopic(scheme, flux=flux), Fixed(4e-3, 60))
        for flux in (None, getattr(mine, name))
    )
    np.testing.assert_allclose(own.h, built_in.h, rtol=1e-12)
    np.testing.assert_allclose(own.q, built_in.q, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(mass(own), mass(own)[0], rtol=1e-14)


@pytest.mark.parametrize("name", ["hll", "closed", "masked"])
@pytest.mark.parametrize("method", [Macroscopic(1), Macroscopic(4), Macroscopic(4, order=2)], ids=repr)
def test_any_flux_keeps_mass_on_dry_ground(mine: ModuleType, name: str, method: Macroscopic) -> None:
    """And no height falls below 0."""
    run = simulate(ends_dry(boundary="wall"), replace(method, flux=getattr(mine, name)), Fixed(4e-3, 100))
    assert run.verdict.kind == "finished"
    assert run.h.min() >= 0.0
    np.testing.assert_allclose(mass(run), mass(run)[0], rtol=1e-13)


def test_a_flux_that_is_none_is_refused_in_a_line() -> None:
    for flux, words in (
        (lambda h_left: 0.0, "takes"), (lambda *states: 3.0, "gives"), (lambda *states: (math.nan, 0.0), "nan"),
    ):  # fmt: skip
        with pytest.raises(InputError, match=words) as refused:
            simulate(wet(), Macroscopic(4, flux=flux), Fixed(4e-3, 2))
        assert "\n" not in str(refused.value)
    with pytest.raises(InputError, match="no function"):
        Macroscopic(4, flux=3.0)


# ---- observers -------------------------------------------------------------------------------------------------------


def test_an_observer_sees_every_fifth_step_and_may_end_the_run(mine: ModuleType) -> None:
    run = simulate(wet(), Macroscopic(4), Fixed(4e-3, 32), 1, observers=[mine.Heaviest()])
    noted = run.observed["heaviest"]
    assert [step for step, _, _ in noted if step % 5 == 0] == [5, 10, 15, 20, 25, 30]
    for n, t, highest in noted:
        assert t == run.t[n]
        assert highest == run.h[n].max()
    short = simulate(wet(), Macroscopic(4), Fixed(4e-3, 32), 1, observers=[mine.Heaviest(20)])
    assert short.verdict.kind == "stopped"
    assert "seen enough" in str(short.verdict)
    assert short.steps == 20
    np.testing.assert_array_equal(short.h, run.h[:21])


def test_a_function_observes_too_and_one_that_fails_keeps_the_run() -> None:
    seen = []

    def watch(block):  # type: ignore[no-untyped-def]
        seen.append(block.step)

    def broken(block):  # type: ignore[no-untyped-def]
        raise RuntimeError("of mine")

    assert simulate(wet(), Macroscopic(4), Fixed(4e-3, 10), observers=[watch]).verdict.kind == "finished"
    assert seen[-1] == 10
    run = simulate(wet(), Macroscopic(4), Fixed(4e-3, 10), observers=[broken])
    assert run.verdict.kind == "observer-failed"
    assert "RuntimeError: of mine" in str(run.verdict)
    assert np.isfinite(run.h).all()


# ---- what a run says of them -----------------------------------------------------------------------------------------


def test_provenance_tells_a_law_of_ones_own(mine: ModuleType) -> None:
    """A subclass that changes nothing has the same numbers, another name and another hash."""
    built_in, own, viscous = (
        simulate(replace(wet(), friction=friction), Macroscopic(4), Fixed(4e-3, 3))
        for friction in (Coulomb(0.2), mine.Wet(0.2), mine.Viscous(0.2, 0.1))
    )
    np.testing.assert_array_equal(own.h, built_in.h)
    told = [run.provenance() for run in (built_in, own, viscous)]
    assert len({one["hash"] for one in told}) == 3
    assert "written_outside.Wet" in told[1]["scene"]
    assert "written_outside.Viscous" in told[2]["scene"]
    assert "outside" not in told[0]["scene"]


def test_provenance_tells_a_flux_of_ones_own(mine: ModuleType) -> None:
    built_in, closed, hll = (
        simulate(wet(), Macroscopic(4, flux=flux), Fixed(4e-3, 3)).provenance()
        for flux in (None, mine.closed, mine.hll)
    )
    assert len({built_in["hash"], closed["hash"], hll["hash"]}) == 3
    assert "written_outside.closed" in closed["method"]
    assert "written_outside.hll" in hll["method"]


# ---- what is told of them --------------------------------------------------------------------------------------------


def hashed(run: Run) -> str:
    return str(run.provenance()["hash"])


def test_other_numbers_never_have_the_same_hash(mine: ModuleType) -> None:
    """A value in a closure, a global value that changes between two runs, and a subclass of anything."""
    seen: dict[str, bytes] = {}

    def add(scene: Scene, method: Macroscopic, clock: Fixed) -> None:
        run = simulate(scene, method, clock)
        assert seen.setdefault(hashed(run), run.q[-1].tobytes()) == run.q[-1].tobytes()

    def weaker(share: float) -> object:
        return lambda *states: tuple(share * part for part in mine.masked(*states))

    scene, clock = wet(), Fixed(1e-3, 10)
    for share in (1.0, 0.9):
        add(scene, Macroscopic(1, flux=weaker(share)), clock)
    for value in (0.2, 0.4):
        mine.MORE = value
        add(replace(scene, friction=mine.Global(0.1)), Macroscopic(4), clock)
    for pull in (0.1, 0.2):
        steeper = type("Steeper", (ConstantSlope,), {"sin": property(lambda slope, pull=pull: pull)})
        add(replace(scene, chute=steeper(0.5)), Macroscopic(4), clock)
    add(scene, Macroscopic(4), clock)
    assert len(seen) == len(set(seen.values())) == 7


def test_a_flux_that_numba_cannot_compile_is_called_face_by_face(mine: ModuleType) -> None:
    """With plain helpers, as an object; what it raises is what the run ends with."""

    class Object:
        def __call__(self, h_left: float, u_left: float, h_right: float, u_right: float, beta: float) -> object:
            if h_left > 5.0:
                raise RuntimeError("too high")
            return mine.hll(h_left, u_left, h_right, u_right, beta) if h_left < 9.0 else {}

    runs = [simulate(wet(), Macroscopic(1, flux=flux), Fixed(1e-3, 10)) for flux in (mine.hll, Object())]
    np.testing.assert_allclose(runs[1].h, runs[0].h, rtol=1e-14)
    high = replace(wet(), heap=Profile(np.full(40, 6.0)))
    assert "flux Object: RuntimeError: too high" in str(
        simulate(high, Macroscopic(1, flux=Object()), Fixed(1e-3, 10)).verdict
    )
