"""Particles that neither collide nor feel each other: the kinetic equation without its projection."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from ..arrays import Array
from ..errors import InputError
from ..model.cells import Cells
from ..value import Number, Whole, value
from .domain import moment, numbers, places
from .quadrature import cell_edges

Density = Callable[[Array, Array], Array]


@value
class FreeTransport:
    """f_t + xi f_x + g f_xi = 0 with f = f0 at t = 0; call it with (x, xi, t) to get f.

    Each particle moves with x' = xi, xi' = g, so that it came from xi - g t, x - (xi - g t) t - g t^2/2:

        f(x, xi, t) = f0(x - xi t + g t^2/2, xi - g t).

    One step of a velocity grid without projection is this for t = dt, with error O(dx) and O(dxi): it judges transport
    and force rooms by themselves.

    Valid for all x, xi and t >= 0, wherever f0 is defined.

    Source: the method of characteristics, as above.

    Attributes:
        f0: Density at t = 0, called with arrays x, xi of one shape.
        g: Force on a unit of mass, sin zeta -+ R (dimensionless).
        points: Gauss points per direction in each cell of `averages`.
    """

    f0: Density
    g: Number = 0.0
    points: Annotated[Whole, Field(ge=1, le=64)] = 8

    def __call__(self, x: ArrayLike, xi: ArrayLike, t: float) -> Array:
        """Density at the places `x` and the velocities `xi`, broadcast together, at the time `t`.

        Raises:
            InputError: t is negative or not finite, or an x or xi is not a number.
        """
        t = moment("FreeTransport", t)
        there, speed = np.broadcast_arrays(places("FreeTransport", x), places("FreeTransport", xi))
        with np.errstate(over="ignore", invalid="ignore"):
            start = places("FreeTransport, at the start", there - speed * t + 0.5 * self.g * t * t)
            return numbers("FreeTransport: f0", self.f0(start, speed - self.g * t))

    def averages(self, cells: Cells, xi: ArrayLike, t: float) -> Array:
        """Averages of f over each of the `cells` times each velocity cell, shape (cells.count, len(xi) - 1).

        Gauss quadrature, exact but for rounding where f0 is a polynomial of degree 2 `points` - 1 or less, and as good
        as that for smooth f0 that vary little over a cell and over dxi t; where f0 has a kink, as the rim of M has, the
        error is of the size of one cell in `points`.

        Args:
            cells: The cells of the x-axis.
            xi: Edges of the velocity cells, increasing.
            t: The time.

        Raises:
            InputError: t is negative or not finite, or the edges do not increase.
        """
        edges = places("FreeTransport", xi)
        if edges.ndim != 1 or edges.size < 2 or not (np.diff(edges) > 0.0).all():
            raise InputError("FreeTransport: the edges of the velocity cells do not increase; give two or more, sorted")
        nodes, weights = np.polynomial.legendre.leggauss(self.points)
        x, speed = (_nodes(ends, nodes) for ends in (cell_edges(cells), edges))
        f = self(x[:, :, None, None], speed[None, None], t)
        averages: Array = np.einsum("iajb,a,b->ij", f, 0.5 * weights, 0.5 * weights)
        return averages


def _nodes(edges: Array, nodes: Array) -> Array:
    """Gauss points of each cell, shape (cells, points)."""
    begin, end = edges[:-1, None], edges[1:, None]
    return 0.5 * (begin + end) + 0.5 * (end - begin) * nodes
