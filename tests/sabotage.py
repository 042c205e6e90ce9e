"""Five ways to break the package on purpose, each as a function that does it for the rest of the process.

All of them put other values or classes in the place of those that a model is made of, never another formula in the
place of one: what is compiled and kept on disk stays sound.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from kinsim import printed
from kinsim.compiled import routine
from kinsim.kinetic.force import FORCES, remap
from kinsim.macroscopic import closed_form
from kinsim.schemes import scheme23
from kinsim.schemes.bed import normal, pull
from kinsim.schemes.formulas import is_slow
from kinsim.schemes.friction import resistance
from kinsim.schemes.tile import CANDIDATE, SLOW, Q
from kinsim.solver import model


def printed_flux() -> None:
    """The closed-form fluxes with the misprints of the paper, I3 among them."""

    def of_cells(flux: Any, h: Any, u: Any, beta: Any, out: Any) -> None:
        for i in range(h.size):
            state = float(h[i]), float(u[i]), float(beta[i])
            out[:, i] = printed.I1(*state), printed.I3(*state), printed.I2(*state), printed.I4(*state)

    closed_form.half_moments_of_cells = of_cells  # type: ignore[assignment]


class Backward(NamedTuple):
    """The linear shift, by -J."""

    def push(force, row, M, J, h, dxi, f, i):  # type: ignore[no-untyped-def]
        return 0.0, remap(row, -J, h, dxi, f, i)


def reversed_shift() -> None:
    """A sign error in the shift: f is pushed by -J."""
    FORCES["shift-linear"] = Backward()


def dropped_ghosts() -> None:
    """Ghost cells show what streams out where they should mirror it."""
    model.KINDS["wall"] = model.OPEN


def coupled_by_cell() -> None:
    """The coupling by cell is sold as the one by face, which is conservative."""
    model.CoupledByFace = scheme23.CoupledByCell  # type: ignore[misc, assignment]


sound = routine()(scheme23.Balanced.fluxes)


class Halved(NamedTuple):
    """Scheme 3 by cell, whose cells are slow from half of the momentum on that friction can stop."""

    has_two_fluxes = scheme23.Balanced.has_two_fluxes
    settle = scheme23.Balanced.settle
    has_own_density = scheme23.Balanced.has_own_density
    own_states = scheme23.Balanced.own_states
    takes_own = scheme23.Balanced.takes_own
    balanced_at = scheme23.CoupledByCell.balanced_at

    def fluxes(scheme, order, flux, ground, dt, place, room):  # type: ignore[no-untyped-def]
        top, bed = sound(scheme, order, flux, ground, dt, place, room), ground.bed
        for k in range(-1, place.n + 1):
            R = resistance(ground.law, 1.0, 0.0, normal(bed, place.begin + k, 0.0, 0.0))
            room[SLOW + k] = is_slow(room[Q + k], room[CANDIDATE + k], pull(bed, place.begin + k), R, 0.5 * dt)
        return top


def halved_threshold() -> None:
    """Cells are slow from half of the momentum on that friction can stop."""
    model.CoupledByCell = Halved  # type: ignore[misc, assignment]
