"""Fluxes that others wrote: good ones pass, each broken one is caught in its regime."""

from __future__ import annotations

import ast
import math
import re
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from kinsim import InputError, crosscheck, printed
from kinsim.cli import app
from kinsim.macroscopic.closed_form import ClosedForm, half_moments_of_cells
from kinsim.measure.reference import by_quadrature
from kinsim.measure.regimes import regimes

Fluxes = tuple[np.ndarray, np.ndarray]


def closed(
    hl: np.ndarray, ul: np.ndarray, hr: np.ndarray, ur: np.ndarray, beta: float
) -> tuple[np.ndarray, np.ndarray]:
    left, right = np.empty((4, hl.size)), np.empty((4, hl.size))
    for h, u, out in ((hl, ul, left), (hr, ur, right)):
        half_moments_of_cells(ClosedForm(), h, u, np.full(h.size, float(beta)), out)
    return left[0] + right[2], left[1] + right[3]


def rusanov(
    hl: np.ndarray, ul: np.ndarray, hr: np.ndarray, ur: np.ndarray, beta: float
) -> tuple[np.ndarray, np.ndarray]:
    """Another scheme: consistent and symmetric, but not the kinetic flux."""
    a = np.maximum(np.abs(ul) + np.sqrt(beta * hl), np.abs(ur) + np.sqrt(beta * hr))
    first = 0.5 * (hl * ul + hr * ur) - 0.5 * a * (hr - hl)
    second = 0.5 * (hl * ul**2 + hr * ur**2 + 0.5 * beta * (hl**2 + hr**2)) - 0.5 * a * (hr * ur - hl * ul)
    return first, second


def test_closed_form_passes_everywhere() -> None:
    """Both ways of having (24) agree to rounding, the grid to its own order."""
    found = crosscheck(closed)
    assert found.passes
    assert found.first_failure is None
    for regime in found.regimes:
        assert regime.quadrature <= 1e-13
        assert regime.consistency <= 1e-15
        assert regime.mirror == 0.0
        assert regime.grid <= (1e-2 if regime.name == "fast thin films" else 1e-5)


def test_printed_formulas_fail_where_they_are_wrong() -> None:
    """I3 fails wherever xi = 0 lies inside the support, I4 where the left velocity stands for the right one."""
    found = {regime.name: regime for regime in crosscheck(printed.flux).regimes}
    assert not found["transonic"].passes
    assert found["transonic"].consistency > 1e-2
    assert found["supersonic to the right"].quadrature <= 1e-13
    assert not found["supersonic to the left"].passes
    assert found["supersonic to the left"].consistency <= 1e-13
    assert found["supersonic to the left"].quadrature > 1e-2
    F = printed.flux(1.0, 0.3, 1.0, 0.3, 0.4)
    assert F[1] == pytest.approx(0.110, abs=5e-4)
    assert by_quadrature(tuple(np.array([v]) for v in (1.0, 0.3, 1.0, 0.3)), 0.4)[1][0] == pytest.approx(
        0.290, abs=5e-4
    )


def test_another_scheme_is_consistent_and_symmetric_but_not_kinetic() -> None:
    for regime in crosscheck(rusanov).regimes:
        assert regime.consistency <= 1e-15
        assert regime.mirror <= 1e-15
    failure = crosscheck(rusanov).first_failure
    assert failure is not None
    assert "quadrature, at rest" in str(failure)


def test_broken_symmetry_and_nan_are_found() -> None:
    def lopsided(hl, ul, hr, ur, beta):  # type: ignore[no-untyped-def]
        F1, F2 = closed(hl, ul, hr, ur, beta)
        return F1 + 1e-9 * hl, F2

    def undefined(hl, ul, hr, ur, beta):  # type: ignore[no-untyped-def]
        F1, F2 = closed(hl, ul, hr, ur, beta)
        return F1 * (hr / hr), F2

    assert all(regime.mirror > 1e-12 for regime in crosscheck(lopsided).regimes if "both" not in regime.name)
    by_name = {regime.name: regime for regime in crosscheck(undefined).regimes}
    assert by_name["transonic"].passes
    assert by_name["dry on one side"].quadrature == np.inf


def test_a_built_in_beta_and_nothing_from_nothing_are_found() -> None:
    def built_in(hl, ul, hr, ur, beta):  # type: ignore[no-untyped-def]
        return closed(hl, ul, hr, ur, 0.4)

    def from_nothing(hl, ul, hr, ur, beta):  # type: ignore[no-untyped-def]
        F1, F2 = closed(hl, ul, hr, ur, beta)
        return F1, np.where(hl + hr > 0, F2, np.nan)

    assert not crosscheck(built_in, beta=0.4).passes
    assert [regime.name for regime in crosscheck(from_nothing).regimes if not regime.passes] == ["dry on both sides"]


def test_wrong_where_one_side_is_supersonic_and_the_other_is_not() -> None:
    """F(U_left) wherever the left side is supersonic and the right one clearly is not: right in all other regimes."""

    def upwinded(hl, ul, hr, ur, beta):  # type: ignore[no-untyped-def]
        F = closed(hl, ul, hr, ur, beta)
        hasty = (
            (ul >= np.sqrt(2 * beta * hl)) & (np.abs(ur) < 0.8 * np.sqrt(2 * beta * hr)) & (np.minimum(hl, hr) > 1e-3)
        )
        left = (hl * ul, hl * ul**2 + 0.5 * beta * hl**2)
        return np.where(hasty, left[0], F[0]), np.where(hasty, left[1], F[1])

    failing = {regime.name: regime for regime in crosscheck(upwinded).regimes if not regime.passes}
    assert {"supersonic beside transonic", "transonic beside supersonic"} <= set(failing)
    assert failing["supersonic beside transonic"].quadrature > 1e-2


def test_nothing_from_what_is_fast_is_found() -> None:
    """0 wherever |u| > 4 c on some side: only films are ever so fast."""

    def stopped(hl, ul, hr, ur, beta):  # type: ignore[no-untyped-def]
        F1, F2 = closed(hl, ul, hr, ur, beta)
        slow = (np.abs(ul) <= 4 * np.sqrt(2 * beta * hl)) & (np.abs(ur) <= 4 * np.sqrt(2 * beta * hr))
        return np.where(slow, F1, 0), np.where(slow, F2, 0)

    failing = [regime.name for regime in crosscheck(stopped, count=20).regimes if not regime.passes]
    assert failing == ["fast thin films"]


def test_a_flux_that_raises_fails_there_and_tells_the_state() -> None:
    def proud(hl, ul, hr, ur, beta):  # type: ignore[no-untyped-def]
        if (hl > 9).any():
            raise ValueError("too\nhigh")
        return closed(hl, ul, hr, ur, beta)

    found = crosscheck(proud)
    failures = [regime.failure for regime in found.regimes if regime.failure]
    assert 0 < len(failures) < len(found.regimes)
    for failure in failures:
        assert failure.raised == "ValueError: too high"
        assert failure.state[0] > 9
        assert np.isnan(failure.found).all()
        assert "raised ValueError: too high, expected (" in str(failure)
    first = failures[0]
    h = regimes(np.random.default_rng(0), 400, 0.4)["at rest"][0]
    assert first.state[0] == h[h > 9][0]
    assert next(regime for regime in found.regimes if regime.failure).quadrature == np.inf
    assert all(regime.failure.raised for regime in crosscheck(lambda *given: 1 / 0).regimes if regime.failure)


def test_a_flux_that_has_the_wrong_shape_or_takes_numbers_only_is_refused() -> None:
    with pytest.raises(InputError, match="numbers of type complex128"):
        crosscheck(lambda hl, *rest: (hl * 1j, hl))
    with pytest.raises(InputError, match="returned shapes"):
        crosscheck(lambda *given: (0.0, 0.0))

    def single(hl, ul, hr, ur, beta):  # type: ignore[no-untyped-def]
        if hl == 0 and hr == 0:
            return 0.0, 0.0
        one = closed(*(np.array([part]) for part in (hl, ul, hr, ur)), beta)
        return float(one[0][0]), float(one[1][0])

    for flux in (single, lambda *given: (math.sqrt(given[0]), math.sqrt(given[2]))):
        with pytest.raises(InputError, match=r"single numbers, not arrays .*; vectorise it, e.g. np.vectorize\(flux\)"):
            crosscheck(flux, count=20)
    assert crosscheck(np.vectorize(single), count=20).passes


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"count": 1.5}, "crosscheck: count: should be a valid integer, got 1.5"),
        ({"count": 0}, "crosscheck: count: should be greater than or equal to 1, got 0"),
        ({"seed": -1}, "crosscheck: seed: should be greater than or equal to 0, got -1"),
        ({"seed": None}, "crosscheck: seed: should be a valid integer, got a NoneType"),
        ({"beta": np.nan}, "crosscheck: beta: should be a finite number, got nan"),
        ({"beta": 1e200}, "crosscheck: beta: should be less than or equal to 1000000000000000, got 1e\\+200"),
        ({"beta": 0.4j}, "crosscheck: beta: should be a valid number, got a complex"),
        ({"tolerance": 0}, "crosscheck: tolerance: should be greater than 0, got 0"),
        ({"flux": 3}, "crosscheck: the flux is of type int; give a function"),
    ],
)
def test_bad_arguments_get_one_line(given: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError, match=f"^{line}$"):
        crosscheck(**{"flux": closed, **given})


def test_beta_may_be_any_number() -> None:
    for beta in (5e-324, 1e-300, 1e15, np.float64(0.4), "2/5", 1):
        assert crosscheck(closed, beta=beta, count=20).passes


def test_where_it_first_fails_can_be_pasted() -> None:
    """What stands before and after the sign of equality is Python, with every digit."""
    for flux in (printed.flux, lambda *given: closed(*given[:4], 0.4)):
        failure = crosscheck(flux).first_failure
        assert failure is not None
        call, found = re.fullmatch(r".*: (flux\(.*\)) = (\(.*\)), expected .*", str(failure)).groups()
        given, F = ast.literal_eval(call.removeprefix("flux")), ast.literal_eval(found)
        assert given == (*failure.state, failure.beta)
        again = [float(part[0]) for part in flux(*(np.array([number]) for number in given[:4]), given[4])]
        np.testing.assert_allclose(again, F, rtol=1e-15)


def test_regimes_are_what_they_say() -> None:
    states = regimes(np.random.default_rng(1), 200, 0.4)
    h, u, _, _ = states["supersonic to the left"]
    assert (u <= -np.sqrt(0.8 * h)).all()
    assert not states["dry on one side"][2].any()
    speeds = {
        name: [np.abs(u) / np.sqrt(0.8 * np.where(h > 0, h, 1)) for h, u in ((s[0], s[1]), (s[2], s[3]))]
        for name, s in states.items()
    }
    beside = speeds["supersonic beside transonic"]
    assert (beside[0] >= 1).all()
    assert (beside[1] <= 1).all()
    fast = np.max(speeds["fast thin films"], axis=0)
    assert (fast >= 1).all()
    assert fast.max() > 500
    assert (np.minimum(states["fast thin films"][0], states["fast thin films"][2]) <= 1e-2).all()


def test_crosscheck_from_the_shell() -> None:
    done = CliRunner().invoke(app, ["crosscheck", "kinsim.printed:flux"])
    assert done.exit_code == 1
    assert "first fails" in done.stdout
    asked = CliRunner().invoke(
        app, ["crosscheck", "kinsim.printed:flux", "--count", "7", "--seed", "3", "--tolerance", "99"]
    )
    assert asked.exit_code == 0
    raising = CliRunner().invoke(app, ["crosscheck", "math:dist", "--count", "3"])
    assert "fails, raised TypeError" in " ".join(raising.stdout.split())
    for words, line in (
        (["nowhere:flux"], "nowhere"),
        (["kinsim.printed"], "MODULE:NAME"),
        (["kinsim.printed:no"], "'no'"),
    ):
        bad = CliRunner().invoke(app, ["crosscheck", *words])
        assert bad.exit_code == 2
        assert line in bad.stderr
        assert bad.stderr.count("\n") == 1
