"""Where the error of a run comes from: its velocity grid, dx, dt, and the remap of its force."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..clock import Courant, Fixed
from ..errors import InputError
from ..kinetic.velocity import Fitted, Window
from ..method import Kinetic, Macroscopic
from ..scene import Scene
from ..studies.given import check_given
from ..studies.study import study
from .choose import candidates
from .cost import seconds_per_step
from .judge import check_ended, judge, mass_of
from .pace import steady, twin_of
from .pilot import Pilots, kind_of, nodes, untold

ENOUGH = 0.1
"""A velocity error of this share of the error of dx pays no more."""

NOTICED = 1.05
"""Costs that are closer than this are the same."""


@dataclass(frozen=True)
class Budget:
    """Errors of one run, each L1(h) at the end over the mass at the start and what comes in.

    Attributes:
        total: To the judge.
        velocity: Of the velocity nodes: to the closed-form twin, force remap left out.
        force: Of the remap of the force: to the same run with nodes that move exactly; NaN where there is no remap.
        dt: Of the steps: what the twin has yet to change as they are halved again and again, from two halvings.
        dx: Of the cells: of the twin at a quarter of the step, to the judge.
        closed: Total error of the twin.
        shorter: Total error of the twin with half the step.
        judge: What judged.
        advice: How many velocity nodes would do, in words; empty without velocity nodes to be counted.
    """

    total: float
    velocity: float
    force: float
    dt: float
    dx: float
    closed: float
    shorter: float
    judge: str
    advice: str

    @property
    def words(self) -> str:
        """The budget in sentences."""
        if self.dx == 0.0:
            return f"The cells make no error that the velocity nodes, with {self.velocity:.3g}, could be compared to."
        nodes = f"The velocity nodes contribute {self._percent(self.velocity)} of the dx error"
        remap = f", the remap of the force {self._percent(self.force)}" if np.isfinite(self.force) else ""
        now, then = f"{self.closed:.3g}", f"{self.shorter:.3g}"
        change = "larger" if self.shorter > self.closed else "smaller"
        halved = f"make the whole {change}, {then} for {now}" if then != now else "change nothing"
        return (
            f"{nodes}{remap}, the steps {self._percent(self.dt)}; half the step would {halved}. {self.advice}".rstrip()
        )

    def _percent(self, error: float) -> str:
        return _percent(error / self.dx)


def budget(scene: Scene, method: Kinetic | Macroscopic, clock: Fixed | Courant, **options: Any) -> Budget:
    """The shares of the error of one run.

    They need not add up: dx and dt of a scheme of first order partly cancel.

    Args:
        scene: What happens.
        method: How it is computed.
        clock: When; a Courant clock is taken with steps of one length.
        options: `keep`, `resume`, `tell`, ... of `kinsim.study`.

    Raises:
        InputError: The scene has no mass, or one of the runs does not come to its end.
    """
    check_given("budget", scene, method, clock)
    mass, end, twin = mass_of(scene, clock.end), clock.end, twin_of(method)
    first = clock if isinstance(clock, Fixed) else steady(scene, method, clock.number, end)
    halves = [replace(first, dt=first.dt / part, steps=first.steps * part) for part in (1, 2, 4)]
    runs: list[tuple[Any, Fixed]] = [(method, first), *((twin, one) for one in halves)]
    exact = _exactly(method)
    if exact:
        runs.append((exact, first))
    over = {"method": [one for one, _ in runs], "clock": [one for _, one in runs]}
    found = study(scene, method, first, over, paired=True, **options)
    check_ended(found, "budget: a run", "take a scene and a method that come to the end")
    h = found["h"].to_numpy()
    against = judge(scene, end, 1.0, **options)
    true = against.averages(scene.cells)

    def apart(one: Array, other: Array) -> float:
        return float(np.abs(one - other).sum() * scene.cells.dx / mass)

    unmoved = h[4] if exact else h[0]
    dx = apart(h[3], true)
    return Budget(
        total=apart(h[0], true), velocity=apart(unmoved, h[1]), force=apart(h[0], unmoved) if exact else np.nan,
        dt=_to_the_limit(apart(h[1], h[2]), apart(h[2], h[3])), dx=dx,
        closed=apart(h[1], true), shorter=apart(h[2], true),
        judge=against.what, advice=_advice(scene, method, clock, apart(h[0], h[1]), dx, options),
    )  # fmt: skip


def _exactly(method: Kinetic | Macroscopic) -> Kinetic | None:
    """The same with nodes that the force moves exactly, where they are not yet and can be."""
    if isinstance(method, Macroscopic) or isinstance(method.velocity, Fitted) or method.force == "shift-exact":
        return None
    try:
        return replace(method, force="shift-exact")
    except InputError:
        return None


def _to_the_limit(first: float, second: float) -> float:
    """The sum of a series that goes on as it begins; of the two terms alone if they do not fall."""
    ratio = second / first if first > 0.0 else 0.0
    return first / (1.0 - ratio) if ratio < 0.9 else first + second


def _advice(
    scene: Scene, method: Kinetic | Macroscopic, clock: Fixed | Courant, velocity: float, dx: float, options: Any
) -> str:
    """How many nodes of the same kind would do: fewer that are faster, or more where these are too few."""
    if isinstance(method, Macroscopic) or isinstance(method.velocity, Window):
        return ""
    kind = "fitted nodes" if isinstance(method.velocity, Fitted) else "nodes"
    if why := untold(method):
        return f"How many {kind} would do cannot be said: {why}."
    same = sorted({method, *(one for one in candidates(method) if kind_of(one) == kind_of(method))}, key=nodes)
    pilots = Pilots(scene, same, clock, **options)
    below, at = f"less than {_percent(ENOUGH)}", same.index(method)

    def enough(one: Kinetic) -> bool:
        return pilots.foreseen(one) <= ENOUGH * dx and pilots.predicted(one) <= ENOUGH * dx

    good = velocity <= ENOUGH * dx
    found = list(filter(enough, same[:at])) if good else [one for one in same[at + 1 :] if enough(one)][:1]
    if not found:
        return (
            f"Fewer {kind} would not do for {below}." if good
            else f"No number of {kind} up to {nodes(same[-1])} makes them {below}."
        )  # fmt: skip
    cost = dict(zip(same, seconds_per_step(scene, same, **options), strict=True))
    best = min(found, key=lambda one: cost[one].of(pilots.awake(one)))
    ratio = cost[method].of(pilots.awake(method)) / cost[best].of(pilots.awake(best))
    if good and ratio < NOTICED:
        return f"Fewer {kind} would not be faster."
    return f"{nodes(best)} {kind} would do for {below}, {_faster(ratio)}."


def _faster(ratio: float) -> str:
    if 1.0 / NOTICED < ratio < NOTICED:
        return "at the same cost"
    return f"{ratio:.2g} times faster" if ratio > 1.0 else f"{1.0 / ratio:.2g} times slower"


def _percent(share: float) -> str:
    if 0.0 < share < 1e-3:
        return "under 0.1 percent"
    return f"{100.0 * share:.2g} percent" if share < 10.0 else f"{share:.2g} times"
