"""Whole runs at the extremes: what may be asked of kinsim, as far out as numbers go, and what must not come of it.

The space is drawn by choices alone, so that `random.Random` and hypothesis both can draw from it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol, TypeVar

import numpy as np

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Courant,
    Fitted,
    Fixed,
    Frictionless,
    Inflow,
    InputError,
    Kinetic,
    Macroscopic,
    Profile,
    Run,
    Scene,
    SmoothChute,
    Uniform,
    Window,
    simulate,
)  # fmt: skip
from kinsim.model.slope import Bowl

T = TypeVar("T")

TINY = float(np.finfo(float).tiny)
STOPPED = ("non-finite", "cfl-broken", "window-too-small", "too-many-steps", "refused")
"""Verdicts of runs that came to no end, each of which names its step."""

PLACES = ("lifted_since", "lifted_from", "lifted_to")
"""Columns of the ledger that have no number as long as nothing left the ground."""


class Dice(Protocol):
    """Whatever chooses."""

    def choice(self, among: Sequence[T]) -> T: ...


class Asked(NamedTuple):
    """The arguments of `simulate`."""

    scene: Scene
    method: Kinetic | Macroscopic
    clock: Courant | Fixed
    save_every: int
    force: bool

    def run(self) -> Run:
        """Run it."""
        return simulate(*self[:4], force=self.force)


HEIGHTS = (0.0, -0.0, 5e-324, 1e-310, 2.3e-308, 1e-300, 1e-200, 1e-100, 1e-12, 1e-3, 1.0, 3.0, 1e3, 1e12)
FROUDE = (0.0, -0.0, 5e-324, 1e-300, 1e-8, 0.5, 1.0, 10.0, 1e4, 1e8)
BETA = (1e-12, 1e-6, 1e-3, 1.0, 1.0, 1e3, 1e6, 1e12)
DEGREES = (0.0, 0.0, 1e-10, 5.0, 30.0, 89.0, 89.99, -89.99, -30.0)
LENGTHS = (1e-6, 1e-3, 1.0, 1.0, 1e3, 1e6)


def draw(dice: Dice) -> Asked:
    """A run to ask for.

    Raises:
        InputError: It is refused as soon as it is written down.
    """
    scene, c = _scene(dice)
    return Asked(
        scene, _method(dice, c), _clock(dice, scene, c), dice.choice((1, 7)), dice.choice((False, False, True))
    )


def _heights(dice: Dice, count: int) -> list[float]:
    pattern = dice.choice(("wild", "one scale", "one scale", "one cell", "dry"))
    if pattern == "wild":
        return [dice.choice(HEIGHTS) for _ in range(count)]
    if pattern == "one scale":
        scale = dice.choice(HEIGHTS)
        return [scale * dice.choice((0.0, 0.5, 1.0, 1e-3, 1e-9)) for _ in range(count)]
    h = [0.0] * count
    if pattern == "one cell":
        h[dice.choice(range(count))] = dice.choice(HEIGHTS)
    return h


def _scene(dice: Dice) -> tuple[Scene, float]:
    """A scene, and a speed that belongs to it."""
    h = _heights(dice, dice.choice((2, 2, 3, 4, 5, 8, 17, 40)))
    zeta = math.radians(dice.choice(DEGREES))
    delta = dice.choice((None, 0.0, abs(zeta), math.radians(89.99), 1e-12, 0.3))
    beta, length = dice.choice(BETA), dice.choice(LENGTHS)
    c = math.sqrt(2.0 * beta * max(h)) or 1.0
    froude = dice.choice(FROUDE)
    u = [froude * c * dice.choice((1.0, -1.0, 0.5, 0.0)) for _ in h]
    left = dice.choice((0.0, -length, 1e3 * length))
    bowl = Bowl(dice.choice((1.39, -1.39, 1e-9)), left + 0.5 * length, length * dice.choice((1e-3, 0.3, 1e3)))
    smooth = SmoothChute(bowl, dice.choice((0.0, 1e-6, 1.0, 1e6)), dice.choice(("warn", "stop")))
    stream = Inflow(dice.choice(HEIGHTS[-6:]), froude * c)
    scene = Scene(
        Cells(left, left + length, len(h)), Profile(h, u),
        dice.choice((ConstantSlope(zeta), ConstantSlope(zeta), smooth)),
        Frictionless() if delta is None else Coulomb(delta),
        dice.choice(("open", "wall", "periodic", ("open", "wall"), (stream, "open"))),
        epsilon=beta / math.cos(zeta),
    )  # fmt: skip
    return scene, c * (1.0 + froude)


def _method(dice: Dice, c: float) -> Kinetic | Macroscopic:
    scheme = dice.choice((1, 2, 3, 4, 4, 4, 4))
    of_scheme: dict[str, Any] = {}
    if scheme == 3:
        of_scheme["coupling"] = dice.choice(("cell", "face"))
    if scheme == 4 and dice.choice((True, False)):
        of_scheme |= {"order": 2, "limiter": dice.choice(("minmod", "between", "mc"))}
    elif scheme == 4:
        of_scheme["statics"] = dice.choice(("hold", "reflect"))
    wing = dice.choice(("closed", "fitted", "grid", "grid", "window"))
    if wing == "closed":
        return Macroscopic(scheme, **of_scheme)
    if wing == "fitted":
        return Kinetic(scheme, Fitted(dice.choice((2, 3, 6, 12))), **of_scheme)
    rooms = {
        "equilibrium": dice.choice(("cell-average", "sampled", "matched", "entropic")),
        "force": dice.choice(("shift-linear", "shift-exact", "shift-pfc", "derivative-upwind", "derivative-centred")),
        "projection": dice.choice(("flux-difference", "re-summed")),
    }
    if wing == "window":
        return Kinetic(scheme, Window(max(c, 1e-300) * dice.choice((0.01, 0.1, 0.5, 1.0))), **rooms, **of_scheme)
    bound = dice.choice((None, None, 1e-3 * c, c, 10.0 * c, 1e3 * c))
    count, beyond = dice.choice((2, 4, 8, 64, 500)), dice.choice(("stop", "warn"))
    return Kinetic(scheme, Uniform(count, bound or None, beyond), **rooms, **of_scheme)


def _clock(dice: Dice, scene: Scene, c: float) -> Courant | Fixed:
    across = scene.cells.dx * scene.cells.count / c
    if dice.choice((True, True, False)):
        number, end = dice.choice((0.01, 0.45, 0.49, 0.9, 1.0, 1.0)), dice.choice((1e-6, 1.0, 1.0, 1e3))
        return Courant(number, end * across, stop_at_rest=dice.choice((False, False, True)), most=40)
    return Fixed(dice.choice((1e-12, 0.1, 0.4, 0.9, 3.0, 1e6)) * scene.cells.dx / c, steps=20)


def attempt(dice: Dice) -> tuple[str, str]:
    """Draw a run and take it: the kind of its verdict, or "refused"; and what is wrong with it, or nothing.

    Whoever calls turns warnings into errors; any error but the one-line refusal passes through.
    """
    try:
        asked = draw(dice)
        run = asked.run()
    except InputError as error:
        return "refused", "" if len(str(error).splitlines()) == 1 else f"refused in several lines: {error}"
    return run.verdict.kind, wrong(asked, run)


def wrong(asked: Asked, run: Run) -> str:
    """What must not be and is, of a run that ended or was stopped."""
    numbers = {"t": run.t, "h": run.h, "q": run.q, "u": run.u, "dt": run.dt, **run.entries,
               "mass_drift": np.array(run.mass_drift)}  # fmt: skip
    for name, array in numbers.items():
        if name not in PLACES and not np.isfinite(array).all():
            return f"{name} is not finite: {run.verdict}"
    if run.verdict.step != run.steps or (run.verdict.kind in STOPPED) != (
        f"step {run.steps + 1}: " in str(run.verdict)
    ):
        return f"the verdict names the wrong step, or none: {run.verdict}"
    if run.entries["courant"].max() > 1.0 + 1e-12:
        return ""
    if positive(asked.method) and min(run.h.min(), run.entries["h_min"].min()) < 0.0:
        return f"h fell to {min(run.h.min(), run.entries['h_min'].min())}"
    return unbooked(asked, run)


def positive(method: Kinetic | Macroscopic) -> bool:
    """Whether heights are proved to stay: of schemes 1 and 4, with a shift, and as much mass in M as in the cell.

    The derivative (18) makes f < 0. More than it has may leave a cell whose samples of M hold more; scheme 4 mends it.
    """
    if method.scheme not in (1, 4) or isinstance(method, Macroscopic):
        return method.scheme in (1, 4)
    exact = method.scheme == 4 or method.equilibrium != "sampled" or method.projection == "re-summed"
    return method.force.startswith("shift") and exact


def unbooked(asked: Asked, run: Run) -> str:
    """Mass that came or went and is in no book, beyond rounding and what is below the least height.

    Sums over an f that the derivative (18) drives far to both sides of 0 cancel to any number, and are not asked.
    """
    if isinstance(asked.method, Kinetic) and (asked.method.force[:5], asked.method.projection) == (
        "deriv",
        "re-summed",
    ):
        return ""
    books = run.entries
    parts = [books[name] for name in ("inflow_left", "inflow_right", "coupling_drift", "mended")]
    came, cells = sum(parts), asked.scene.cells
    largest = max(float(np.abs(column).max()) for column in (books["mass"], cells.dx * run.h, *parts))
    rounding = 1e-15 * max(run.steps, 1) * cells.count * largest
    least = 2.0 * TINY * cells.count * max(run.steps, 1) * max(cells.dx, 1.0)
    missing = float(np.abs(books["mass"] - books["mass"][0] - came).max())
    return f"mass {missing:.3g} of {books['mass'][0]:.3g} is in no book" if missing > rounding + least else ""
