"""Fluxes that others wrote: good ones pass, each broken one is caught in its regime."""

from __future__ import annotations

import ast
import re
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from kinsim import InputError, crosscheck, printed
from kinsim.cli import app
from kinsim.macroscopic.half_moments import flux_closed
from kinsim.measure.reference import by_quadrature
from kinsim.measure.regimes import regimes

Fluxes = tuple[np.ndarray, np.ndarray]


def closed(
    hl: np.ndarray, ul: np.ndarray, hr: np.ndarray, ur: np.ndarray, beta: float
) -> tuple[np.ndarray, np.ndarray]:
    F1, F2 = np.empty_like(hl), np.empty_like(hl)
    flux_closed(hl, ul, hr, ur, beta, F1, F2)
    return F1, F2


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
        assert regime.grid <= 1e-2


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


def test_a_flux_that_raises_or_has_the_wrong_shape_is_refused() -> None:
    with pytest.raises(InputError, match="the flux failed with ZeroDivisionError"):
        crosscheck(lambda *given: 1 / 0)
    with pytest.raises(InputError, match="complex numbers"):
        crosscheck(lambda hl, *rest: (hl * 1j, hl))
    with pytest.raises(InputError, match="returned shapes"):
        crosscheck(lambda *given: (0.0, 0.0))


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


def test_crosscheck_from_the_shell() -> None:
    done = CliRunner().invoke(app, ["crosscheck", "kinsim.printed:flux"])
    assert done.exit_code == 1
    assert "first fails" in done.stdout
    for words, line in (
        (["nowhere:flux"], "nowhere"),
        (["kinsim.printed"], "MODULE:NAME"),
        (["kinsim.printed:no"], "'no'"),
    ):
        bad = CliRunner().invoke(app, ["crosscheck", *words])
        assert bad.exit_code == 2
        assert line in bad.stderr
        assert bad.stderr.count("\n") == 1
