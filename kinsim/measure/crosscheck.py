"""Judge a flux that somebody else wrote: against quadrature, against the grid, and against itself."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from ..arrays import Array
from ..errors import InputError
from ..value import Number, Whole, checked
from .reference import by_quadrature, on_grid
from .regimes import States, regimes

Flux = Callable[..., tuple[Any, Any]]

ASKED = {
    "beta": Annotated[Number, Field(gt=0, le=1e15)],
    "count": Annotated[Whole, Field(ge=1)],
    "tolerance": Annotated[Number, Field(gt=0)],
    "seed": Annotated[Whole, Field(ge=0)],
}
"""What may be asked."""

OTHER = 2.3
"""The flux is asked again at so many times beta."""


@dataclass(frozen=True)
class Failure:
    """The first state at which a check fails.

    Attributes:
        check: Which one.
        state: h_left, u_left, h_right, u_right.
        beta: The beta that the flux was asked at.
        found, expected: (F1, F2) as given, NaN if it raised, and as they should be.
        raised: What it raised there, in one line; empty if it gave an answer.
    """

    check: str
    state: tuple[float, float, float, float]
    beta: float
    found: tuple[float, float]
    expected: tuple[float, float]
    raised: str = ""

    def __str__(self) -> str:
        answer = f"raised {self.raised}" if self.raised else f"= {self.found}"
        return f"{self.check}: flux{(*self.state, self.beta)} {answer}, expected {self.expected}"


@dataclass(frozen=True)
class Regime:
    """What was found in one regime; errors are maxima over its states, in flux scales h (|u| + c)^k of the two sides,
    and infinite where the flux raises.

    Attributes:
        name: Which regime.
        quadrature: Difference to half-range moments of M by quadrature: the flux of (24).
        grid: The same to sums over a velocity grid of `reference.NODES` cells, whose own error is of order n^-2.
        consistency: |F(U, U) - F(U)|, F(U) = (h u, h u^2 + beta h^2/2).
        mirror: Departure from mirror symmetry, F1 odd and F2 even under x to -x.
        failure: Where the first check beyond the tolerance fails, or None.
    """

    name: str
    quadrature: float
    grid: float
    consistency: float
    mirror: float
    failure: Failure | None

    @property
    def passes(self) -> bool:
        """Whether every check holds."""
        return self.failure is None


@dataclass(frozen=True)
class CrossCheck:
    """The findings, regime by regime."""

    beta: float
    tolerance: float
    regimes: tuple[Regime, ...]

    @property
    def passes(self) -> bool:
        """Whether every check holds in every regime."""
        return all(regime.passes for regime in self.regimes)

    @property
    def first_failure(self) -> Failure | None:
        """The first state at which anything fails, or None."""
        return next((regime.failure for regime in self.regimes if regime.failure), None)


def crosscheck(
    flux: Flux, *, beta: float = 0.4, count: int = 400, tolerance: float = 1e-12, seed: int = 0
) -> CrossCheck:
    """Check a numerical flux of the kinetic scheme, regime by regime.

    A flux that raises fails; the first state at which it does is sought.

    Args:
        flux: Vectorised, ``flux(h_left, u_left, h_right, u_right, beta) -> (F1, F2)`` for arrays of one shape.
        beta: As in (1), > 0 and at most 1e15; the flux is asked at 2.3 beta, too.
        count: Random states per regime, at least 1.
        tolerance: Largest error allowed, in flux scales.
        seed: Of the random states.

    Raises:
        InputError: The flux takes one state at a time, or does not return two real arrays of the shape it was given;
            or a number is none.
    """
    given = {"beta": beta, "count": count, "tolerance": tolerance, "seed": seed}
    beta, count, tolerance, seed = (checked(f"crosscheck: {name}", ASKED[name], given[name]) for name in given)
    if not callable(flux):
        raise InputError(f"crosscheck: the flux is of type {type(flux).__name__}; give a function")
    dice = np.random.default_rng(seed)
    there = [_judge(name, states, flux, beta, tolerance) for name, states in regimes(dice, count, beta).items()]
    other = OTHER * beta  # a flux that has beta built in is right at one beta only
    elsewhere = [_judge(name, states, flux, other, tolerance) for name, states in regimes(dice, count, other).items()]
    worse = (_worse(one, two) for one, two in zip(there, elsewhere, strict=True))
    return CrossCheck(beta, tolerance, tuple(worse))


def _worse(one: Regime, two: Regime) -> Regime:
    return Regime(
        one.name,
        quadrature=max(one.quadrature, two.quadrature), grid=max(one.grid, two.grid),
        consistency=max(one.consistency, two.consistency), mirror=max(one.mirror, two.mirror),
        failure=one.failure or two.failure,
    )  # fmt: skip


def _judge(name: str, states: States, flux: Flux, beta: float, tolerance: float) -> Regime:
    h_left, u_left, h_right, u_right = states
    mirrored = (h_right, -u_right, h_left, -u_left)
    same = (h_left, u_left, h_left, u_left)
    (found, error), (turned, error_turned), (alone, error_alone) = (
        _ask(flux, given, beta) for given in (states, mirrored, same)
    )
    scale = _scale(h_left, u_left, beta) + _scale(h_right, u_right, beta)
    exact = by_quadrature(states, beta)
    closed = (h_left * u_left, h_left * u_left**2 + 0.5 * beta * h_left**2)
    checks = (
        ("quadrature", states, found, exact, scale, error),
        ("consistency F(U, U)", same, alone, closed, 2.0 * _scale(h_left, u_left, beta), error_alone),
        ("mirror symmetry", mirrored if error_turned else states, found, (-turned[0], turned[1]), scale, error_turned),
    )
    errors, failure = [], None
    for check, given, got, expected, size, raised in checks:
        off = _off(got, expected, size)
        errors.append(float(off.max()))
        bad = np.flatnonzero(~(off <= tolerance))
        if failure is None and bad.size:
            i = _first_raising(flux, given, beta) if raised else int(bad[0])
            state = (float(given[0][i]), float(given[1][i]), float(given[2][i]), float(given[3][i]))
            if raised:
                expected = by_quadrature(given, beta)
            answer, right = ((float(pair[0][i]), float(pair[1][i])) for pair in (got, expected))
            if raised:
                answer = (math.nan, math.nan)
            failure = Failure(f"{check}, {name}", state, beta, answer, right, raised)
    grid = float(_off(found, on_grid(states, beta), scale).max())
    return Regime(name, errors[0], grid, errors[1], errors[2], failure)


def _ask(flux: Flux, states: States, beta: float) -> tuple[tuple[Array, Array], str]:
    """The answer, and what the flux raised instead, NaN being the answer then."""
    try:
        first, second = _call(flux, states, beta)
    except (Exception, SystemExit) as error:  # somebody else's code may raise anything
        _refuse_single(flux, states, beta, error)
        nothing = np.full(states[0].shape, np.nan)
        return (nothing, nothing), _said(error)
    for part in (first, second):
        if part.shape != states[0].shape:
            raise InputError(
                f"crosscheck: the flux returned shapes {first.shape} and {second.shape} "
                f"for states of {states[0].shape}; return two arrays of the shape of h_left"
            )
        if part.dtype.kind not in "biuf":
            raise InputError(f"crosscheck: the flux returned numbers of type {part.dtype}; return real ones")
    return (first.astype(float), second.astype(float)), ""


def _call(flux: Flux, states: States, beta: float) -> tuple[Array, Array]:
    with np.errstate(all="ignore"):
        first, second = (np.asarray(part) for part in flux(*(s.copy() for s in states), beta))
    return first, second


def _said(error: BaseException) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())}".removesuffix(": ")


def _raises(flux: Flux, states: Any, beta: float) -> bool:
    try:
        _call(flux, states, beta)
    except (Exception, SystemExit):
        return True
    return False


def _refuse_single(flux: Flux, states: States, beta: float, error: BaseException) -> None:
    """A flux that takes the first states one by one as numbers, but not two of them together, is not vectorised."""
    both = tuple(np.repeat(s[:1], 2) for s in states)
    if _raises(flux, both, beta) and not _raises(flux, tuple(s[0] for s in states), beta):
        raise InputError(
            f"crosscheck: the flux takes single numbers, not arrays ({_said(error)}); vectorise it, e.g. "
            "np.vectorize(flux)"
        )


def _first_raising(flux: Flux, states: States, beta: float) -> int:
    """The first state that the flux raises at when it comes alone; the last if it raises at many together only."""
    low, high = 0, states[0].size  # none of the first `low` states raises, some of the first `high` does
    while high - low > 1:
        middle = (low + high) // 2
        if _raises(flux, tuple(s[low:middle] for s in states), beta):
            high = middle
        else:
            low = middle
    return low


def _scale(h: Array, u: Array, beta: float) -> Array:
    """The flux scales h (|u| + c) and h (|u| + c)^2, shape (2, count)."""
    speed = np.abs(u) + np.sqrt(2.0 * beta * h)
    return np.array([h * speed, h * speed**2])


def _off(found: tuple[Array, Array], expected: tuple[Array, Array], scale: Array) -> Array:
    """The larger error of the two components in flux scales, shape (count,); NaN counts as infinite."""
    size = np.maximum(scale, np.finfo(float).tiny)
    off: Array = np.max(np.abs(np.array(found) - np.array(expected)) / size, axis=0)
    return np.where(np.isnan(off), np.inf, off)
