"""The cheapest method whose velocity error will stay below what is asked."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from typing import Any

import numpy as np

from ..clock import Courant, Fixed, first_courant
from ..diagnostics.endings import over_the_bound
from ..errors import InputError
from ..interrupt import unless_interrupted
from ..kinetic.velocity import Fitted, Uniform
from ..measure.compare import method_name
from ..method import Kinetic, Macroscopic
from ..run import ENDED, Run
from ..scene import Scene
from ..simulate import simulate
from ..solver.march import ROUNDING
from ..studies.given import check_given
from ..studies.member import ONCE
from .cost import Cost, seconds_per_step
from .judge import mass_of
from .pilot import Pilots, kind_of, nodes, untold

FITTED = (1, 2, 3, 4, 6, 8)
COUNTS = (8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512)


@dataclass(frozen=True)
class Chosen:
    """What was picked.

    Attributes:
        method: The method.
        accuracy: What was asked.
        predicted: Its velocity error, at most: L1(h) to the closed-form twin at the end, over the mass at the start and
            what comes in.
        share: Its cost per step over that of the dearest candidate, in which no cell rests.
        why: A sentence.
    """

    method: Kinetic
    accuracy: float
    predicted: float
    share: float
    why: str


def candidates(method: Kinetic, grid: bool = False) -> list[Kinetic]:
    """Methods like this one that differ in their velocity nodes; fitted ones only where they can be had."""
    found: list[Kinetic] = []
    for velocity in (*(() if grid else map(Fitted, FITTED)), *map(Uniform, COUNTS)):
        try:
            found.append(replace(method, velocity=velocity))
        except InputError:  # fitted nodes carry M itself, and some equilibria need many nodes
            continue
    return found


def choose(
    scene: Scene,
    method: Kinetic | Macroscopic,
    clock: Fixed | Courant,
    *,
    accuracy: float,
    grid: bool = False,
    among: Sequence[Kinetic] | None = None,
    **options: Any,
) -> Chosen:
    """Pick velocity nodes for a scene: the cheapest whose velocity error is predicted to stay below `accuracy`.

    Costs of a step are timed on the scene; errors, and the share of the cells that rest are
    measured on pilots with fewer cells (see `kinsim.trades.pilot`), from the cheapest candidate on, until no other can
    be cheaper. Candidates that the measured order of their kind rules out are left out.

    Args:
        scene: What happens.
        method: All but its velocity nodes is kept.
        clock: Its end is the end of the run.
        accuracy: L1(h) to the closed-form twin at the end, over the mass at the start and what comes in; > 0.
        grid: Take a velocity grid, which shows f, and no fitted nodes.
        among: Candidates of your own.
        options: `keep`, `resume`, `tell`, ... of `kinsim.study`.

    Raises:
        InputError: It cannot be had; the message names the nearest that can. Or the scheme is not 4, pilot runs
            tell nothing, or an argument makes no sense.
    """
    check_given("choose", scene, method, clock)
    if not isinstance(method, Kinetic):
        raise InputError("choose: the closed form has no velocity error; leave out the accuracy, or take Kinetic")
    if isinstance(accuracy, bool) or not isinstance(accuracy, Real) or not 0.0 < accuracy < math.inf:
        raise InputError(f"choose: accuracy = {accuracy!r} is no error to stay below; take a number > 0, such as 1e-4")
    if why := untold(method):
        raise InputError(f"choose: {why}; take scheme 4 (--set method.scheme=4)")
    accuracy = float(accuracy)
    _check_steps(scene, method, clock)
    rest = candidates(method, grid) if among is None else _own(among, method)
    if not rest:
        raise InputError("choose: there are no candidates; give at least one")
    pilots = Pilots(scene, rest, clock, **options)
    costs = dict(zip(rest, seconds_per_step(scene, rest, **options), strict=True))
    dearest = max(cost.of(1.0) for cost in costs.values())
    rest.sort(key=lambda one: costs[one].of(1.0))
    best = _cheapest(rest, costs, pilots, accuracy) or min(rest, key=pilots.predicted)
    error = pilots.predicted(best)
    if error <= accuracy:
        share, own = costs[best].of(pilots.awake(best)), pilots.awake(best)
        cheaper = sum(costs[one].of(pilots.least_awake) < share and not pilots.keeps(one, accuracy) for one in rest)
        return Chosen(best, accuracy, error, share / dearest, _why(best, accuracy, pilots, cheaper, len(rest), own))
    if not math.isfinite(error):
        raise InputError("choose: no run comes to its end; take a scene and a method that do")
    raise InputError(
        f"choose: a velocity error below {accuracy:.3g} cannot be had; the nearest is {error:.2g}, "
        f"with {best.velocity.words}: ask for {_up(error):.2g}"
    )


def _check_steps(scene: Scene, method: Kinetic, clock: Fixed | Courant) -> None:
    """There is mass, and the first step keeps the CFL bound; all pilots would break it, too."""
    mass_of(scene, clock.end)
    courant, dx = first_courant(scene, clock), scene.cells.dx
    if courant > 1.0 + ROUNDING:
        speed = scene.fastest
        raise InputError(f"choose: {over_the_bound(courant * dx / speed, speed, dx, clock, 1.0)}")


def _own(among: Any, method: Kinetic) -> list[Kinetic]:
    """Candidates of the caller's own, if they share the twin of `method`."""
    if not isinstance(among, Sequence):
        raise InputError(f"choose: among is a {type(among).__name__}; give a list of Kinetic methods")
    for at, one in enumerate(among):
        if not isinstance(one, Kinetic) or not isinstance(one.velocity, (Uniform, Fitted)):
            what = one.velocity.words if isinstance(one, Kinetic) else type(one).__name__
            raise InputError(f"choose: among[{at}] is {what}; give Kinetic methods with Uniform or Fitted nodes")
        if one.twin != method.twin:
            raise InputError(
                f"choose: among[{at}] has another closed form ({one.twin}) than the method ({method.twin}); "
                "let them differ in velocity nodes, equilibrium, force and projection alone"
            )
    return list(among)


def _cheapest(
    ordered: Sequence[Kinetic], costs: Mapping[Kinetic, Cost], pilots: Pilots, accuracy: float
) -> Kinetic | None:
    """The one of least cost that will do; `ordered` by the cost of a step in which no cell rests.

    What would be dearer even if as many of its cells slept as ever did is left out, and so is at first what the order
    of its kind rules out; that is looked at after all from the most nodes of its kind on, as long as these will do.
    """
    best, passed = None, []

    def cost(one: Kinetic) -> float:
        return costs[one].of(pilots.awake(one))

    def better(one: Kinetic) -> bool:
        if best is not None and costs[one].of(pilots.least_awake) >= cost(best):
            return False
        return pilots.predicted(one) <= accuracy and (best is None or cost(one) < cost(best))

    for one in ordered:
        if best is None and pilots.foreseen(one) > accuracy:
            passed.append(one)
        elif better(one):
            best = one
    lost = set()
    for one in sorted(passed, key=nodes, reverse=True):
        if kind_of(one) in lost:
            continue
        if better(one):
            best = one
        elif accuracy < pilots.predicted(one) < math.inf:  # of one that stopped, fewer nodes may come to the end
            lost.add(kind_of(one))
    return best


def _up(error: float) -> float:
    """The next number of two digits that is not below."""
    digit = 10.0 ** (math.floor(math.log10(error)) - 1)
    return math.ceil(error / digit * (1.0 - 1e-12)) * digit


def _why(method: Kinetic, accuracy: float, pilots: Pilots, cheaper: int, of: int, awake: float) -> str:
    before = f"the {cheaper} cheaper ones of {of} would miss it" if cheaper else f"the cheapest of {of} candidates"
    margin = f"a margin of {pilots.margin:.2g} included" if pilots.foretells(method) else "measured on all cells"
    predicted = f"predicted {pilots.predicted(method):.2g} <= {accuracy:.2g}, {margin}"
    sleeping = f"; {100.0 * awake:.0f} percent of its cells are awake" if awake < 0.995 else ""
    return f"{method_name(method)}: {predicted}; {before}{sleeping}"


def velocity_error(run: Run) -> float:
    """What the velocity nodes of a run did: L1(h) at its end to the closed-form twin, step by step the same, over
    the mass; inf if it was stopped, or the twin cannot take these steps.

    Raises:
        InputError: The run is the twin.
    """
    if isinstance(run.method, Macroscopic):
        raise InputError("velocity error: the closed form has none; give a kinetic run")
    if run.verdict.kind not in ENDED:
        return math.inf
    taken = simulate(run.scene, run.method.twin, run.replay, ONCE, force=True)  # a thin front of its own may be faster
    twin = unless_interrupted(taken)
    if twin.steps < run.steps:
        return math.inf
    return float(np.abs(run.h[-1] - twin.h[-1]).sum() * run.scene.cells.dx / mass_of(run.scene, run.clock.end))
