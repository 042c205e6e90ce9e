"""Five ways to break the package on purpose, each as a function that does it for the rest of the process.

All of them replace Python around the kernels, never a kernel: what is compiled and kept on disk stays sound.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kinsim import printed
from kinsim.balance import schemes, stages
from kinsim.kinetic.wing import Density
from kinsim.macroscopic import wing


def printed_flux() -> None:
    """The closed-form fluxes with the misprints of the paper, I3 among them."""

    def flux(hl: Any, ul: Any, hr: Any, ur: Any, beta: float, room: Any, F1: np.ndarray, F2: np.ndarray) -> None:
        F1[:], F2[:] = printed.flux(hl, ul, hr, ur, beta)

    def of_cells(h: Any, u: Any, beta: float, room: Any, F1: np.ndarray, F2: np.ndarray) -> None:
        flux(h[:-1], u[:-1], h[1:], u[1:], beta, room, F1, F2)

    wing.flux_closed, wing.flux_of_cells = flux, of_cells


def reversed_shift() -> None:
    """A sign error in the shift: f is pushed by -J."""

    def push(self: Density, f: Any, M: Any, now: Any, out: Any) -> float:
        return self._force(f, M, -now.J, self.pulled(now), self.grid.dxi, out, self.offset)

    Density._push = push  # type: ignore[method-assign]


def dropped_ghosts() -> None:
    """Ghost cells show what streams out where they should mirror it, in the rooms and in the sweeps."""
    from kinsim import stepper  # which takes the names of the others when it is loaded

    def extend(boundary: object, h: np.ndarray, u: np.ndarray) -> None:
        h[0], h[-1], u[0], u[-1] = h[1], h[-2], u[1], u[-2]

    stages.extend = extend
    stepper.shown = lambda boundary, nx: (0, nx - 1, False, False)


def coupled_by_cell() -> None:
    """The coupling by cell is sold as the one by face, which is conservative."""
    schemes.Scheme3Face = schemes.Scheme3Cell  # type: ignore[misc]


def halved_threshold() -> None:
    """Cells are slow from half of the momentum on that friction can stop."""
    sound = schemes.find_slow

    def find_slow(q: Any, h1: Any, s: float, R: float, dt: float, slow: Any) -> None:
        sound(q, h1, s, R, 0.5 * dt, slow)

    schemes.find_slow = find_slow
