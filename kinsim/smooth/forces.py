"""Forces that all give (13), and what each leaves of the semicircle at rest.

With gamma = beta'/beta and A = u^2 + rho/2, rho = beta h, the quadratic force

    F_c = g + c gamma (xi^2 - A)

has for c = 1/2 the moments of Theorem 2: M_t + xi M_x + F M_xi = Q, (17), with M the density of rho. For *every* c it
has those of the conservative form f_t + xi f_x + (F_c f)_xi = Q with f the density (12) of h and the beta of the place;
c = 1/2 is (17) divided by beta, c = 0 the rigid shift. The affine force

    F = g + gamma rho/2 + gamma u (xi - u)

serves (17) as well as its own does. Here g is the total acceleration of (13), not gravity. The functions take numbers
or arrays, broadcast, all dimensionless; "at rest" is u = 0 and rho_x = g + gamma rho/2, which is beta h_x + beta' h/2 =
g, with g what friction lets rest need.
"""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

from ..arrays import Array

Numbers = float | Array
T = TypeVar("T")
"""Numbers, arrays, or symbols of computer algebra."""


def mean_square(rho: T, u: T) -> T:
    """A = u^2 + rho/2, the mean of xi^2 under the equilibrium."""
    return u * u + rho / 2  # type: ignore[operator, no-any-return]


def quadratic(xi: T, rho: T, u: T, gamma: T, g: T, c: T) -> T:
    """F_c = g + c gamma (xi^2 - A); c = 1/2 is the force of (17)."""
    return g + c * gamma * (xi * xi - mean_square(rho, u))  # type: ignore[operator, no-any-return]


def affine(xi: T, rho: T, u: T, gamma: T, g: T) -> T:
    """F = g + gamma rho/2 + gamma u (xi - u)."""
    return g + gamma * rho / 2 + gamma * u * (xi - u)  # type: ignore[operator, no-any-return]


def residual_of_17(xi: Numbers, rho: Numbers, gamma: Numbers) -> Array:
    """Q of (17) at rest, xi gamma (3 rho - 2 xi^2) / (4 pi sqrt(2 rho - xi^2)) inside |xi| < sqrt(2 rho), 0 outside.

    It grows without bound towards the rim. With the affine force it is 0 for all xi.
    """
    xi, rho = np.asarray(xi, dtype=float), np.asarray(rho, dtype=float)
    square: Array = 2.0 * rho - xi * xi
    inside = square > 0.0
    root = np.sqrt(np.where(inside, square, 1.0))
    return np.where(inside, xi * gamma * (3.0 * rho - 2.0 * xi * xi) / (4.0 * math.pi * root), 0.0)


def residual_of_family(xi: Numbers, rho: Numbers, beta: Numbers, gamma: Numbers, c: float) -> Array:
    """Q of F_c in conservative form at rest: (2 - 6 c) times that of (17) over -beta, so 0 for all xi if c = 1/3."""
    return (6.0 * c - 2.0) / np.asarray(beta) * residual_of_17(xi, rho, gamma)
