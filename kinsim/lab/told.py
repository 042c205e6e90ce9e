"""What a stage of a step does, in a sentence with the equation that it takes."""

from __future__ import annotations

from ..method import Kinetic
from .play import Moment, Play

START = "<b>Start.</b> The velocities in each cell are those of the equilibrium M(h, ξ - u), a semicircle, (12)."

TRANSPORT = (
    "<b>1 Transport.</b> Particles move at their own velocity ξ through the walls of the cells: "
    "f = M - λ ξ (M<sub>i+½</sub> - M<sub>i-½</sub>), (23). f is no semicircle any more."
)

FORCE = "<b>2 Force.</b> Gravity and friction accelerate all particles of a cell alike: "

PUSHED = {
    "shift-linear": "f moves along ξ by Δt g, (21) to (23), between two nodes in proportion.",
    "shift-pfc": "f moves along ξ by Δt g, (21) to (23), along limited parabolas between the nodes.",
    "shift-exact": "f moves along ξ by Δt g, (21) to (23), and its nodes with it.",
    "derivative-upwind": "f changes by Δt g times its slope along ξ, (18), taken on the side it comes from.",
    "derivative-centred": "f changes by Δt g times its slope along ξ, (18), taken on both sides.",
}

PROJECTION = (
    "<b>3 Projection.</b> Only the mass and the momentum that the step leaves in each cell are kept, (20); "
    "M of these is where the next step begins."
)

SLOPED = "Order 2 gives cells slopes, and sums up what those show to the wall; shaded is what means show."

REFLECTED = (
    "Scheme 4 with reflecting statics turns particles round at a face that friction holds; shaded is what comes to it."
)

COUPLED = "Slow cells take the balanced face (25), others the upwind one (19): a step tells which this does."


def told(moment: Moment, method: Kinetic, forced: bool) -> str:
    """The stage that a moment shows, as HTML; `forced` says whether anything pulls or brakes."""
    if not moment.step:
        return START
    if moment.stage == "force":
        return FORCE + (PUSHED[method.force] if forced else "here nothing does, and f stays as it is.")
    return TRANSPORT if moment.stage == "transport" else PROJECTION


def passing(play: Play, moment: Moment, cell: int) -> str:
    """What the scheme sums up at the right wall of a cell, if no choice of faces says so; a sentence or nothing."""
    method = play.method
    if method.order == 2:
        return SLOPED
    if method.scheme == 4 and method.statics == "reflect":
        return REFLECTED
    if method.scheme != 3:
        return ""
    if not moment.step or moment.stage == "projection":
        return COUPLED
    slow = play.takes_balanced(min(cell, moment.h.size - 2))
    return f"In this step the cell took {'the balanced face (25)' if slow else 'the upwind face (19)'} here."
