"""How a run ends, in words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..clock import AnyClock, Fixed
from ..solver.asked import largest_sum
from ..solver.march import AT_REST as RESTS
from ..solver.march import (
    BEYOND,
    COURANT,
    FASTEST_OF_ALL,
    LIFTED,
    NOT_FINITE,
    OUTSIDE,
    RESTING,
    ROUNDING,
    STILL,
    TOO_SHORT,
)
from .lift import lift_words
from .resolution import unresolved

if TYPE_CHECKING:
    from ..solver.solver import Block, Solver
    from .ledger import Ledger

VerdictKind = Literal[
    "finished", "at-rest", "non-finite", "cfl-broken", "window-too-small", "lifted-off", "too-many-steps", "refused",
    "interrupted", "stopped", "observer-failed",
]  # fmt: skip

ENDED: tuple[VerdictKind, ...] = ("finished", "at-rest")
"""Kinds of runs that came to their end."""

FORCED = ", or force it (--force, force=True)"
"""What else can be done about a step over the CFL bound, where a run can be forced."""

LIFTED_WORDS = "the mass left the ground, and the chute is strict; stopped"


@dataclass(frozen=True)
class Verdict:
    """How a run ended; `str` says it in human words.

    Attributes:
        kind: "finished", "at-rest", "non-finite", "cfl-broken", "window-too-small", "lifted-off", "too-many-steps",
            "refused" (a step asks for what cannot be had), "interrupted", "stopped" (by an observer) or
            "observer-failed".
        message: One sentence.
        step: Number of the last step kept.
        cell: The cell at fault, if one is.
    """

    kind: VerdictKind
    message: str
    step: int
    cell: int | None = None

    def __str__(self) -> str:
        return self.message


def ending(block: Block, clock: AnyClock) -> tuple[VerdictKind, str, int | None] | None:
    """Why a run ends with this block, in words, and the cell at fault; None if it goes on."""
    solver, reason = block.solver, block.reason
    dx, end = solver.scene.cells.dx, clock.end
    if block.last:
        return ("at-rest", "at rest", None) if solver.seen[STILL] >= RESTING else ("finished", "finished", None)
    if reason == RESTS:
        return "at-rest", "came to rest", None
    if reason == LIFTED:
        return "lifted-off", LIFTED_WORDS, None
    asked = f"velocities up to {max(solver.counted, solver.fastest):.3g} ask for"
    if reason == TOO_SHORT:
        words = f"{asked} steps of dt = {solver.attempted:.3g}, too short to come to t = {end:g}; stopped"
        return "too-many-steps", words, None
    if block.step >= clock.most:
        return "too-many-steps", f"{asked} more than {clock.most} steps; stopped", None
    if reason == COURANT:
        dt, speed = solver.attempted, solver.counted
        if not speed * dt / dx < math.inf:
            return "non-finite", f"the Courant number of dt = {dt:.4g} is not finite; stopped", None
        return "cfl-broken", f"{over_the_bound(dt, speed, dx, clock, solver.limit)}{FORCED}; stopped", None
    if reason == OUTSIDE:
        return "window-too-small", f"{outside(solver)}; stopped", None
    if reason == NOT_FINITE:
        words, cell = fault(solver)
        place = "" if cell is None else f" in cell {cell} (x = {solver.scene.x[cell]:.4g})"
        return "non-finite", f"{words}{place}; stopped", cell
    return None


def verdict(kind: VerdictKind, message: str, solver: Solver, ledger: Ledger, cell: int | None = None) -> Verdict:
    """A verdict on the run so far, in words, with the step."""
    stopped = kind in ("non-finite", "cfl-broken", "window-too-small", "too-many-steps", "refused")
    where = f"step {solver.step + 1}: " if stopped else ""
    notes = [f"{where}{message} at t = {solver.t:.6g} after {solver.step} steps"]
    if ledger.worst_courant > solver.limit * (1.0 + ROUNDING):
        notes.append(f"the CFL bound was broken on demand, Courant number up to {ledger.worst_courant:.3g}")
    if solver.seen[BEYOND] > 0.0 and kind != "window-too-small":
        notes.append(f"{outside(solver)}, what is outside was left out and booked")
    if ledger.least_height < 0:
        notes.append(f"heights fell to {ledger.least_height:.3g}")
    if ledger.least_density < 0:
        why = ", as balanced faces allow" if solver.method.scheme in (2, 3) else ""
        notes.append(f"f fell to {ledger.least_density:.3g} somewhere{why}")
    notes.append(lift_words(solver.scene, solver.seen))
    if solver.grid is not None:
        notes.append(unresolved(solver.method.velocity_cells, solver.grid.bound, solver.scene.beta, solver.h))
    return Verdict(kind, "; ".join(note for note in notes if note), solver.step, cell)


def outside(solver: Solver) -> str:
    """That velocities leave the window, and which one would do."""
    assert solver.grid is not None
    reach, bound = solver.seen[BEYOND], solver.grid.bound
    return f"velocities reach {reach:.4g}, outside the window of {bound:.4g} (take a bound of {1.05 * reach:.3g})"


def over_the_bound(dt: float, speed: float, dx: float, clock: AnyClock, limit: float) -> str:
    """That a step breaks the CFL bound, and what does not."""
    allowed, courant = limit * dx / speed, speed * dt / dx
    remedy = f"take dt <= {allowed:.4g}" if isinstance(clock, Fixed) else f"take a Courant number of at most {limit:g}"
    return f"dt = {dt:.4g} breaks the CFL bound (28): Courant number {courant:.4g}; {remedy}"


def fault(solver: Solver) -> tuple[str, int | None]:
    """What is wrong with the step that was refused, and in which cell."""
    stages = solver.stages(solver.h, solver.q, solver.attempted, solver.t)
    h, q = stages["h1"], stages["q1"]
    bad = ~(np.isfinite(h) & np.isfinite(q))
    trouble = getattr(solver.model.flux, "trouble", None)
    if bad.any() and trouble:
        return trouble[-1], int(np.argmax(bad))
    if bad.any():
        return "h or q is not finite", int(np.argmax(bad))
    speed = np.abs(q) / np.where(h > 0.0, h, math.inf)
    c = np.sqrt(2.0 * solver.scene.beta * np.maximum(h, 0.0))
    if not float((speed + c).max()) <= FASTEST_OF_ALL:
        return f"a velocity is beyond {FASTEST_OF_ALL:g}", int(np.argmax(speed))
    most = np.maximum(np.abs(h), np.abs(q))
    if not h.size * float(most.max()) < largest_sum(solver):
        return "the mass or momentum of all cells is not finite, or not beside the mass of the start", int(
            np.argmax(most)
        )
    parts = {name: abs(part) for name, part in stages.books._asdict().items()}
    worst = max(parts, key=lambda name: (not math.isfinite(parts[name]), parts[name]))
    return f"the book {worst!r} is not finite, or not beside the mass of the start", None
