"""The time loop."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence

import numpy as np

from .balance.stages import Array
from .clock import Clock, Fixed
from .dump import Dump, Recorder
from .errors import InputError
from .kernel import kernel
from .kinetic.velocity import Fitted, Uniform
from .kinetic.wing import Density
from .method import Kinetic, Macroscopic
from .run import LEDGER, Run, Verdict, VerdictKind
from .scene import Scene
from .step import Books, Stepper

Progress = Callable[[float], None]

REST_STEPS = 100
"""So many steps in a row without motion are called rest."""

ROUNDING = 1e-12
"""By so much a Courant number may pass 1: the rounding of its own computation."""


def simulate(
    scene: Scene,
    method: Kinetic | Macroscopic,
    clock: Clock,
    save_every: int = 100,
    *,
    force: bool = False,
    dumps: Sequence[Dump] = (),
    progress: Progress | None = None,
) -> Run:
    """Run a scene.

    Args:
        scene: What happens.
        method: How it is computed.
        clock: When.
        save_every: Every so many steps the state is kept, and at the start and at the end.
        force: Run although the CFL bound (28) is broken; the verdict says so.
        dumps: Densities to keep; kinetic wing only.
        progress: Called now and then with the share that is done.

    Returns:
        The run; its verdict says whether it went to the end. A run that is stopped keeps its last good state.

    Raises:
        InputError: The first step would break the CFL bound, or the request makes no sense.
    """
    if save_every < 1:
        raise InputError(f"save_every = {save_every} is below 1; take 1 to keep every step")
    if dumps and (isinstance(method, Macroscopic) or isinstance(method.velocity, Fitted)):
        raise InputError("dumps need a density on a velocity grid: take a Kinetic method with Uniform or Window")
    if isinstance(method, Kinetic) and method.unbounded:
        method = method.within(find_bound(scene, method, clock))
    loop = _Loop(scene, method, clock, save_every, force, dumps)
    began = time.perf_counter()
    try:
        verdict = loop.run(progress)
    except KeyboardInterrupt:
        verdict = loop.verdict("interrupted", "interrupted")
    return loop.finish(verdict, time.perf_counter() - began)


def find_bound(scene: Scene, method: Kinetic, clock: Clock) -> float:
    """1.05 times the largest |u| + c + dt |g| of a run of the closed-form twin, face states included."""
    twin = _Loop(scene, method.twin, clock, save_every=2**62, force=True, dumps=())
    twin.run(None)
    largest = max(twin.fastest, twin.reached) + max(twin.dts, default=0.0) * (abs(scene.chute.sin) + scene.resistance)
    return 1.05 * largest if 0.0 < largest < math.inf else 1.0


class _Loop:
    """The moving parts of a run."""

    def __init__(
        self,
        scene: Scene,
        method: Kinetic | Macroscopic,
        clock: Clock,
        save_every: int,
        force: bool,
        dumps: Sequence[Dump],
    ) -> None:
        self.scene, self.method, self.clock = scene, method, clock
        self.save_every, self.force = save_every, force
        self.h, self.q = scene.initial()
        self.step, self.t = 0, 0.0
        self.stepper = Stepper(scene, method)
        self.recorders = [Recorder(dump, scene, self.stepper.density) for dump in dumps if self.stepper.density]
        self.dts: list[float] = []
        self.times: list[float] = []
        self.states: list[tuple[Array, Array]] = []
        self.rows: list[dict[str, float]] = []
        self.booked = Books(0.0, 0.0, 0.0, 0.0)
        self.still = 0
        self.worst_courant = 0.0
        self.reached = 0.0
        self.outside = ""
        h_min, u_max, self.fastest, _, _, _ = survey(self.h, self.q, scene.beta)
        self._since = (h_min, u_max, 0.0)
        self._warm_up()
        self._save()

    def run(self, progress: Progress | None) -> Verdict:
        """Step until the clock or a fault ends it."""
        scene, method, clock, stepper = self.scene, self.method, self.clock, self.stepper
        dx, beta = scene.cells.dx, scene.beta
        beyond = method.velocity.beyond if isinstance(method, Kinetic) and isinstance(method.velocity, Uniform) else ""
        while True:
            speed = stepper.begin(self.h, self.q)
            dt = clock.next_dt(self.step, self.t, speed, dx)
            if dt is None:
                return self._end()
            courant = speed * dt / dx
            if courant > 1.0 + ROUNDING and not self.force:
                if self.step == 0:
                    raise InputError(_over_the_bound(courant, dt, dx / speed, clock))
                return self.verdict("cfl-broken", f"{_over_the_bound(courant, dt, dx / speed, clock)}; stopped before")
            reached = stepper.reach()
            density = stepper.density
            outside = density is not None and reached > density.grid.bound * (1.0 + ROUNDING)
            if outside and beyond == "stop":
                return self.verdict("window-too-small", f"{_outside(reached, density)}; stopped before")
            books = stepper.advance(dt)
            if outside and density is not None:
                self.outside = _outside(reached, density)
                books = books._replace(window_loss=books.window_loss + dx * density.cut(stepper.now))
            now = stepper.now
            h_min, u_max, fastest, q_max, h_max, bad = survey(now.h1, now.q1, beta)
            if bad >= 0:
                return self.verdict(
                    "non-finite", f"h or q is not finite in cell {bad} (x = {scene.x[bad]:.4g}); stopped before", bad
                )
            after = clock.time_after(self.step + 1, self.t, dt)
            for recorder in self.recorders:
                recorder.record(self.step + 1, self.t, after)
            self.h[:], self.q[:] = now.h1, now.q1
            self.step, self.t = self.step + 1, after
            self.dts.append(dt)
            self.booked = Books(*map(sum, zip(self.booked, books, strict=True)))
            self.still = self.still + 1 if q_max <= stepper.rest(h_max) else 0
            self.worst_courant = max(self.worst_courant, courant)
            self.reached, self.fastest = max(self.reached, reached), max(self.fastest, fastest)
            self._since = (min(self._since[0], h_min), max(self._since[1], u_max), max(self._since[2], courant))
            if self.step % self.save_every == 0:
                self._save()
            if progress and self.step % 16 == 0:
                progress(clock.progress(self.step, self.t))

    def verdict(self, kind: VerdictKind, message: str, cell: int | None = None) -> Verdict:
        """A verdict on the run so far, in words, with the step."""
        forced = f" (CFL bound broken on demand, Courant number up to {self.worst_courant:.3g})"
        over = forced if self.worst_courant > 1.0 + ROUNDING else ""
        negative = min([*(row["h_min"] for row in self.rows), self._since[0]])
        cut = f"; {self.outside}, what is outside was left out and booked" if self.outside else ""
        below = f"; heights fell to {negative:.3g}" if negative < 0 else ""
        where = f"step {self.step + 1}: " if kind in ("non-finite", "cfl-broken", "window-too-small") else ""
        return Verdict(
            kind, f"{where}{message} at t = {self.t:.6g} after {self.step} steps{over}{cut}{below}", self.step, cell
        )

    def finish(self, verdict: Verdict, wall_time: float) -> Run:
        """The run as a value; the last good state is its last row."""
        if not self.times or self.times[-1] != self.t:
            self._save()
        if self.step and verdict.kind in ("finished", "at-rest"):
            for recorder in self.recorders:
                recorder.record(self.step, self.t - self.dts[-1], self.t, final=True)
        return Run(
            scene=self.scene, method=self.method, clock=self.clock, t=np.array(self.times),
            h=np.array([h for h, _ in self.states]), q=np.array([q for _, q in self.states]),
            dt=np.array(self.dts), verdict=verdict, wall_time=wall_time,
            entries={name: np.array([row[name] for row in self.rows]) for name in LEDGER},
            dumps={recorder.dump.name: recorder.result() for recorder in self.recorders},
        )  # fmt: skip

    def _end(self) -> Verdict:
        if self.still >= REST_STEPS:
            return self.verdict("at-rest", "at rest")
        return self.verdict("finished", "finished")

    def _warm_up(self) -> None:
        """Take a step that nobody keeps, so that compiling does not count as running."""
        with np.errstate(all="ignore"):
            self.stepper.begin(self.h, self.q)
            self.stepper.advance(1e-3 * self.scene.cells.dx)
        survey(self.h, self.q, self.scene.beta)
        self.stepper.reach()

    def _save(self) -> None:
        dx = self.scene.cells.dx
        density = self.stepper.density
        f_mass = f_momentum = 0.0
        if density is not None and self.step:
            weights = density.grid.dxi * dx
            f_mass = math.fsum(density.f.sum(axis=1)) * weights - math.fsum(self.h) * dx
            f_momentum = (
                math.fsum(density.f @ density.xi + density.offset * density.f.sum(axis=1)) * weights
                - math.fsum(self.q) * dx
            )
        h_min, u_max, courant = self._since
        self.times.append(self.t)
        self.states.append((self.h.copy(), self.q.copy()))
        self.rows.append({
            "mass": math.fsum(self.h) * dx, "momentum": math.fsum(self.q) * dx,
            "h_min": h_min, "u_max": u_max, "courant": courant, **self.booked._asdict(),
            "sampling_mass": f_mass, "sampling_momentum": f_momentum,
        })  # fmt: skip
        self._since = (math.inf, 0.0, 0.0)


def _outside(reached: float, density: Density | None) -> str:
    bound = density.grid.bound if density else math.inf
    return f"velocities reach {reached:.4g}, outside the window of {bound:.4g} (take a bound of {1.05 * reached:.3g})"


def _over_the_bound(courant: float, dt: float, allowed: float, clock: Clock) -> str:
    remedy = f"take dt <= {allowed:.4g}" if isinstance(clock, Fixed) else "take a Courant number of at most 1"
    return f"dt = {dt:.4g} breaks the CFL bound (28): Courant number {courant:.4g}; {remedy}, or force it"


@kernel
def survey(h: Array, q: Array, beta: float) -> tuple[float, float, float, float, float, int]:
    """Least h, largest |u|, largest |u| + c, largest |q|, largest h, and the first cell that is not finite or -1."""
    h_min, u_max, fastest, q_max, h_max = np.inf, 0.0, 0.0, 0.0, 0.0
    for i in range(h.size):
        if not (np.isfinite(h[i]) and np.isfinite(q[i])):
            return h_min, u_max, fastest, q_max, h_max, i
        h_min, h_max, q_max = min(h_min, h[i]), max(h_max, h[i]), max(q_max, abs(q[i]))
        if h[i] > 0.0:
            u = abs(q[i] / h[i])
            u_max = max(u_max, u)
            fastest = max(fastest, u + np.sqrt(2.0 * beta * h[i]))
    return h_min, u_max, fastest, q_max, h_max, -1
