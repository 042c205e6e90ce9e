"""Judge a flux that somebody else wrote: against quadrature, against the grid, and against itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from ..errors import InputError
from ..value import Number, Whole, checked
from .reference import by_quadrature, on_grid
from .regimes import Array, States, regimes

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
        found, expected: (F1, F2) as given and as they should be.
    """

    check: str
    state: tuple[float, float, float, float]
    beta: float
    found: tuple[float, float]
    expected: tuple[float, float]

    def __str__(self) -> str:
        return f"{self.check}: flux{(*self.state, self.beta)} = {self.found}, expected {self.expected}"


@dataclass(frozen=True)
class Regime:
    """What was found in one regime; errors are maxima over its states, in flux scales h (|u| + c)^k of the two sides.

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

    Args:
        flux: Vectorised, ``flux(h_left, u_left, h_right, u_right, beta) -> (F1, F2)`` for arrays of one shape.
        beta: As in (1), > 0 and at most 1e15; the flux is asked at 2.3 beta, too.
        count: Random states per regime, at least 1.
        tolerance: Largest error allowed, in flux scales.
        seed: Of the random states.

    Raises:
        InputError: The flux raises, or does not return two arrays of the shape it was given; or a number is none.
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
    found, turned, alone = (_ask(flux, given, beta) for given in (states, mirrored, same))
    scale = _scale(h_left, u_left, beta) + _scale(h_right, u_right, beta)
    exact = by_quadrature(states, beta)
    closed = (h_left * u_left, h_left * u_left**2 + 0.5 * beta * h_left**2)
    checks = (
        ("quadrature", states, found, exact, scale),
        ("consistency F(U, U)", same, alone, closed, 2.0 * _scale(h_left, u_left, beta)),
        ("mirror symmetry", states, found, (-turned[0], turned[1]), scale),
    )
    errors, failure = [], None
    for check, given, got, expected, size in checks:
        off = _off(got, expected, size)
        errors.append(float(off.max()))
        bad = np.flatnonzero(~(off <= tolerance))
        if failure is None and bad.size:
            i = int(bad[0])
            state = (float(given[0][i]), float(given[1][i]), float(given[2][i]), float(given[3][i]))
            pairs = [(float(pair[0][i]), float(pair[1][i])) for pair in (got, expected)]
            failure = Failure(f"{check}, {name}", state, beta, pairs[0], pairs[1])
    grid = float(_off(found, on_grid(states, beta), scale).max())
    return Regime(name, errors[0], grid, errors[1], errors[2], failure)


def _ask(flux: Flux, states: States, beta: float) -> tuple[Array, Array]:
    try:
        with np.errstate(all="ignore"):
            first, second = (np.asarray(part) for part in flux(*(s.copy() for s in states), beta))
        if np.iscomplexobj(first) or np.iscomplexobj(second):
            raise TypeError("it returned complex numbers")
        first, second = first.astype(float), second.astype(float)
    except (Exception, SystemExit) as error:  # somebody else's code may raise anything
        said = " ".join(str(error).split())
        raise InputError(f"crosscheck: the flux failed with {type(error).__name__}: {said}") from error
    if first.shape != states[0].shape or second.shape != states[0].shape:
        raise InputError(
            f"crosscheck: the flux returned shapes {first.shape} and {second.shape} for states of {states[0].shape}"
        )
    return first, second


def _scale(h: Array, u: Array, beta: float) -> Array:
    """The flux scales h (|u| + c) and h (|u| + c)^2, shape (2, count)."""
    speed = np.abs(u) + np.sqrt(2.0 * beta * h)
    return np.array([h * speed, h * speed**2])


def _off(found: tuple[Array, Array], expected: tuple[Array, Array], scale: Array) -> Array:
    """The larger error of the two components in flux scales, shape (count,); NaN counts as infinite."""
    size = np.maximum(scale, np.finfo(float).tiny)
    off: Array = np.max(np.abs(np.array(found) - np.array(expected)) / size, axis=0)
    return np.where(np.isnan(off), np.inf, off)
