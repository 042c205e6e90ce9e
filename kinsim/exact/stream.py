"""The steady stream on a smooth chute."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import InputError
from ..model.cells import Cells
from ..model.chute import SmoothChute
from ..model.friction import Friction, formula_of
from .quadrature import averages


@dataclass(frozen=True)
class SteadyStream:
    """h u = `discharge` everywhere, entering at `left` with the velocity `u` > c, and as long as u > c.

    With h = q/u, (13) is (q u + beta q^2/(2 u^2))' = g q/u, so that

        u' = (g/u - beta' q/(2 u^2))/(1 - beta q/u^3),   g = sin zeta - r(h, |u|, cos zeta + eta kappa u^2).

    Attributes:
        chute: The ground.
        friction: Its law of friction.
        scale: beta/cos zeta, epsilon k of the scene.
        discharge: q, > 0.
        u: Velocity at `left`.
        left, right: Where it is known.
    """

    chute: SmoothChute
    friction: Friction
    scale: float
    discharge: float
    u: float
    left: float
    right: float

    def __call__(self, x: Array, t: float = 0.0) -> tuple[Array, Array]:
        """h, u at the places x, at any time.

        Raises:
            InputError: A place lies outside, or the stream is slower than its waves there.
        """
        outside = (x < self.left) | (x > self._end)
        if outside.any():
            raise InputError(
                f"stream: x = {x[outside][0]:g} is not between {self.left:g} and {self._end:g}, where it is known and "
                "faster than its waves"
            )
        u = self._solved.sol(x)[0]
        return self.discharge / u, u

    def averages(self, cells: Cells, t: float = 0.0) -> tuple[Array, Array]:
        """Averages of h and of q = h u over each of the `cells`, each of shape (cells.count,), to fourth order."""
        return averages(self, [], cells)

    @property
    def _end(self) -> float:
        return float(self._solved.t[-1])

    @cached_property
    def _solved(self) -> Any:
        from scipy.integrate import solve_ivp

        return solve_ivp(
            lambda x, u: self._slope(np.full(1, x), u), (self.left, self.right), [self.u], method="DOP853",
            rtol=1e-12, atol=1e-13, dense_output=True, events=_critical(self),
        )  # fmt: skip

    def _slope(self, x: Array, u: Array) -> Array:
        zeta, rise = self.chute.zeta(x)
        beta, beta_rise = self.scale * np.cos(zeta), -self.scale * np.sin(zeta) * rise
        normal = np.maximum(np.cos(zeta) - self.chute.eta * rise * u * u, 0.0)
        q = self.discharge
        g = np.sin(zeta) - np.vectorize(formula_of(self.friction))(q / u, np.abs(u), normal)
        return np.asarray((g / u - beta_rise * q / (2.0 * u * u)) / (1.0 - beta * q / u**3))

    def margin(self, x: float, u: float) -> float:
        """u over the speed at which waves stand, less 1."""
        beta = self.scale * float(np.cos(self.chute.zeta(np.full(1, x))[0][0]))
        return float(u**3 / (beta * self.discharge)) - 1.0


def _critical(stream: SteadyStream) -> Any:
    def event(x: float, u: Array) -> float:
        return stream.margin(x, float(u[0])) - 1e-3

    event.terminal = True  # type: ignore[attr-defined]
    return event
