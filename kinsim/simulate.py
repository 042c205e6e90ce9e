"""The time loop."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from .balance.scheme4 import Held
from .balance.stages import Array
from .checkpoint import Checkpoint, Keeper, Kept, Nowhere, part, under
from .clock import AnyClock, Courant, Fixed, Replay
from .errors import InputError
from .interrupt import Deferred
from .kinetic.velocity import Uniform
from .kinetic.wing import Density
from .memory import require, require_history
from .method import Kinetic, Macroscopic
from .model.chute import SmoothChute
from .model.ground import Flat
from .model.heap import Profile, Table
from .model.slope_table import SlopeTable
from .run import Run, Verdict, VerdictKind, description
from .scene import Scene
from .sleep import Awake
from .stepper import make_stepper
from .watch.causes import Causes
from .watch.dump import Dump, Recorder
from .watch.fault import find_fault, room_beside
from .watch.ledger import Ledger
from .watch.survey import Survey

Progress = Callable[[float], None]

REST_STEPS = 100
"""So many steps in a row without motion are called rest."""

ROUNDING = 1e-12
"""By so much a Courant number may pass 1: the rounding of its own computation."""

FORCED = ", or force it (--force, force=True)"
"""What else can be done about a step over the CFL bound, where a run can be forced."""


LIFTED = "the mass left the ground, and the chute is strict; stopped"

SHORTEST = 1e-9
"""Steps shorter than this share of the whole time are not worth taking."""


@np.errstate(all="ignore")  # a number that is none stops the run, with a verdict
def simulate(
    scene: Scene,
    method: Kinetic | Macroscopic,
    clock: AnyClock,
    save_every: int = 100,
    *,
    force: bool = False,
    dumps: Sequence[Dump] = (),
    causes: bool = False,
    checkpoint: Checkpoint | None = None,
    progress: Progress | None = None,
) -> Run:
    """Run a scene.

    Args:
        scene: What happens.
        method: How it is computed.
        clock: When.
        save_every: Every so many steps the state is kept, and at the start and at the end.
        force: Run although the CFL bound (28) is broken; the verdict says so.
        dumps: Densities to keep; kinetic wing on a velocity grid only.
        causes: Keep the moment ledger, too: what each stage did to mass, momentum, energy and entropy; grid only.
        checkpoint: Where the run is put down now and then, and on Ctrl-C and SIGTERM; `resume` goes on with it.
        progress: Called now and then with the share that is done.

    Returns:
        The run; its verdict says whether it went to the end. A run that is stopped keeps its last good state.

    Raises:
        InputError: The first step would break the CFL bound, or the request makes no sense.
    """
    _check(scene, method, clock, save_every)
    if isinstance(method, Kinetic) and method.unbounded:
        method = method.within(find_bound(scene, method, clock, force))
    loop = Loop(scene, method, clock, save_every, force)
    loop.watch(dumps, causes)
    if checkpoint:
        loop.keeper = Keeper(checkpoint, loop.about())
    loop.start()
    return go(loop, progress)


def go(loop: Loop, progress: Progress | None) -> Run:
    """Step to the end, or until somebody stops it."""
    try:
        with Deferred() as interrupt:
            verdict = loop.run(progress, interrupt)
    except KeyboardInterrupt:
        verdict = loop.verdict("interrupted", "interrupted")
    return loop.finish(verdict)


def _check(scene: Scene, method: Kinetic | Macroscopic, clock: AnyClock, save_every: int) -> None:
    """The three that meet here are what they should be."""
    for name, given, kinds in (
        ("scene", scene, (Scene,)),
        ("method", method, (Kinetic, Macroscopic)),
        ("clock", clock, (Fixed, Courant, Replay)),
    ):
        if not isinstance(given, kinds):
            wanted = " or ".join(kind.__name__ for kind in kinds)
            raise InputError(f"simulate: {name} is of type {type(given).__name__}; give a {wanted}")
    if not isinstance(save_every, (int, np.integer)):
        raise InputError(f"simulate: save_every = {save_every!r} is no number of steps; take a whole one, 1 or more")
    if save_every < 1:
        raise InputError(f"save_every = {save_every} is below 1; take 1 to keep every step")


def find_bound(scene: Scene, method: Kinetic, clock: AnyClock, force: bool = False) -> float:
    """1.05 times the largest |u| + c + dt |g| of a run of the closed-form twin, face states included.

    Where the twin breaks the CFL bound it ends, unless forced: so does then the run itself, on its own grid.
    """
    twin = Loop(scene, method.twin, clock, save_every=2**62, force=force)
    twin.start()
    try:
        verdict = twin.run(None, Deferred())
    except InputError:  # a first step over the bound; the grid counts its nodes, and judges by itself
        verdict = None
    if verdict is not None and verdict.kind == "non-finite":  # forced beyond (28): what blows up asks for any window
        return 10.0 * twin.first_reach or 1.0
    largest = twin.reached + max(twin.dts, default=0.0) * float(np.max(np.abs(scene.pull) + scene.resistance))
    return 1.05 * largest if 0.0 < largest < math.inf else 1.0


class Loop:
    """The moving parts of a run."""

    def __init__(
        self, scene: Scene, method: Kinetic | Macroscopic, clock: AnyClock, save_every: int, force: bool
    ) -> None:
        self.scene, self.method, self.clock = scene, method, clock
        self.save_every, self.force = save_every, force
        self.h, self.q = scene.initial()
        self.before = (self.h.copy(), self.q.copy())
        self.step, self.t = 0, 0.0
        self.dts: list[float] = []
        self.times: list[float] = []
        self.states: list[tuple[Array, Array]] = []
        self.still = 0
        self.foreseen = 0
        self.began = time.perf_counter()
        self.fastest = Survey.of(self.h, self.q, scene.beta).fastest
        self.first_reach = self.reached = 0.0
        self.falling = _falling(scene, clock)
        self.outside = ""
        self.stepper = make_stepper(scene, method)
        self.awake = Awake(scene, method, self.stepper)
        self.ledger = Ledger(scene, self.stepper)
        self.recorders: list[Recorder] = []
        self.causes: Causes | None = None
        self.keeper: Keeper | Nowhere = Nowhere()
        self._warm_up()

    def watch(self, dumps: Sequence[Dump], causes: bool) -> None:
        """Ask for densities and for the moment ledger."""
        density = self.stepper.density
        names = [dump.name for dump in dumps]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"two dumps are called {name!r}; give each a name of its own")
        if density is None:
            if dumps or causes:
                raise InputError(
                    "dumps and causes need a density on a velocity grid: take Kinetic with Uniform or Window"
                )
            return
        if causes and not isinstance(self.scene.ground, Flat):
            raise InputError("the moment ledger is one of a constant slope; leave out causes on a smooth chute")
        if self.stepper.limit < 1.0 and causes:
            raise InputError(
                "the moment ledger follows one stage; order 2 takes two: take order 1, or leave out causes"
            )
        if any(dump.stage == "held" for dump in dumps) and type(self.stepper.scheme) is not Held:
            raise InputError('a dump of the stage "held" needs faces that hold: take scheme 4 of order 1')
        self.recorders = [Recorder(dump, self.scene, density) for dump in dumps]
        for recorder in self.recorders:
            rows = recorder.rows(self.clock.steps if isinstance(self.clock, Fixed) else 1)
            require(rows * 8.0 * recorder.width * density.grid.count, f"{rows} rows of the dump {recorder.dump.name!r}")
        if causes:
            self.causes = Causes(self.scene, self.stepper, density)

    def start(self) -> None:
        """Keep the initial state; from now on time counts."""
        self._foresee()
        self.began = time.perf_counter()
        self.ledger.start(self.h, self.q)
        self._save()

    def run(self, progress: Progress | None, interrupt: Deferred) -> Verdict:
        """Step until the clock or a fault ends it; what is refused in the first step is refused before the run."""
        steps = self.steps()
        while not interrupt.asked:
            try:
                next(steps)
            except StopIteration as end:
                verdict: Verdict = end.value
                return verdict
            self.keeper.after_step(self.kept)
            if progress and self.step % 16 == 0:
                progress(self.clock.progress(self.step, self.t))
        self.keeper.put_down(self.kept())
        return self.verdict("interrupted", "interrupted")

    def steps(self) -> Generator[None, None, Verdict]:
        """Take a step each time it is asked for the next; the stages of the step stand in the stepper until then."""
        try:
            return (yield from self._steps())
        except InputError as error:
            if self.step == 0:
                raise
            return self.verdict("refused", f"{error}; stopped")

    def _steps(self) -> Generator[None, None, Verdict]:
        scene, clock, stepper, awake = self.scene, self.clock, self.stepper, self.awake
        dx, beta = scene.cells.dx, scene.beta
        sleepy = self._same_length()
        room = room_beside(self.ledger.first_mass, dx)
        look = Survey.of(self.h, self.q, beta)
        if self.step == 0 and self.ledger.lift.note(0.0, self.h, self.q):
            return self.verdict("lifted-off", LIFTED)
        while True:
            speed = awake.begin(self.h, self.q, sleepy if self._unseen() else None)
            reach = awake.at.reach() if awake.at else 0.0
            dt = clock.next_dt(self.step, self.t, max(speed, self.fastest, self.falling), dx)
            if dt is None:
                self.reached = max(self.reached, reach)
                return self._end()
            if isinstance(clock, Courant) and dt < SHORTEST * clock.end and clock.end - self.t > dt:
                asked = f"velocities up to {max(speed, self.fastest):.3g} ask for steps of dt = {dt:.3g}"
                return self.verdict("too-many-steps", f"{asked}, too short to come to t = {clock.end:g}; stopped")
            if isinstance(clock, Courant) and self.step >= clock.most:
                asked = f"velocities up to {max(speed, self.fastest):.3g} ask for more than {clock.most} steps"
                return self.verdict("too-many-steps", f"{asked}; stopped")
            courant = speed * dt / dx
            if not courant < math.inf:
                return self.verdict("non-finite", f"the Courant number of dt = {dt:.4g} is not finite; stopped")
            if courant > stepper.limit * (1.0 + ROUNDING) and not self.force:
                if self.step == 0:
                    raise InputError(over_the_bound(dt, speed, dx, clock, stepper.limit) + FORCED)
                return self.verdict(
                    "cfl-broken",
                    f"{over_the_bound(dt, speed, dx, clock, stepper.limit)}{FORCED}; stopped",
                )
            self.reached = max(self.reached, reach)
            cut = self._cut(stepper.density, reach)
            if cut is None:
                return self.verdict("window-too-small", f"{self.outside}; stopped")
            books = awake.advance(self.h, self.q, dt)
            h1, q1 = awake.h1, awake.q1
            if awake.at:
                look = Survey.of(h1, q1, beta)
            if cut:
                books = books._replace(window_loss=books.window_loss + dx * cut)
            booked = self.ledger.with_these(books)
            fault = find_fault(look, h1, q1, booked, room)
            if fault:
                place = "" if fault.cell is None else f" in cell {fault.cell} (x = {scene.x[fault.cell]:.4g})"
                return self.verdict("non-finite", f"{fault.words}{place}; stopped", fault.cell)
            after = clock.time_after(self.step + 1, self.t, dt)
            self.still = self.still + 1 if look.q_max <= stepper.rest(look.h_max) else 0
            settled = clock.stop_at_rest and self.still > 0 and self._settled(h1, q1, look.h_max)
            last = self._accept(h1, q1, dt, after)
            lifted = self.ledger.lift.note(self.t, self.h, self.q)
            self.ledger.note(look, courant, booked, awake.at.density if awake.at else None)
            self.fastest = look.fastest
            if last or self.step % self.save_every == 0:
                self._ask_for_rows()
                self.ledger.save(self.h, self.q)
                self._save()
            if lifted:
                return self.verdict("lifted-off", LIFTED)
            if settled and not last:
                return self.verdict("at-rest", "came to rest")
            yield

    def verdict(self, kind: VerdictKind, message: str, cell: int | None = None) -> Verdict:
        """A verdict on the run so far, in words, with the step."""
        ledger = self.ledger
        where = (
            f"step {self.step + 1}: "
            if kind in ("non-finite", "cfl-broken", "window-too-small", "too-many-steps", "refused")
            else ""
        )
        notes = [f"{where}{message} at t = {self.t:.6g} after {self.step} steps"]
        if ledger.worst_courant > self.stepper.limit * (1.0 + ROUNDING):
            notes.append(f"the CFL bound was broken on demand, Courant number up to {ledger.worst_courant:.3g}")
        if self.outside and kind != "window-too-small":
            notes.append(f"{self.outside}, what is outside was left out and booked")
        if ledger.least_height < 0:
            notes.append(f"heights fell to {ledger.least_height:.3g}")
        if ledger.least_density < 0:
            why = ", as balanced faces allow" if self.stepper.scheme.uses_balanced else ""
            notes.append(f"f fell to {ledger.least_density:.3g} somewhere{why}")
        if ledger.lift.words:
            notes.append(ledger.lift.words)
        if self.keeper.trouble:
            notes.append(self.keeper.trouble)
        return Verdict(kind, "; ".join(notes), self.step, cell)

    def about(self) -> dict[str, Any]:
        """What is run, and what is asked of it."""
        dumps = [TypeAdapter(Dump).dump_python(recorder.dump, mode="json") for recorder in self.recorders]
        described = description(_on_its_own(self.scene), self.method, self.clock)
        return {
            "version": version("kinsim"), **described, "dumps": dumps,
            "save_every": int(self.save_every), "force": self.force, "causes": self.causes is not None,
        }  # fmt: skip

    def kept(self) -> Kept:
        """All that the next step depends on, and all that was kept so far."""
        numbers = (self.step, self.t, self.still, self.fastest, self.first_reach, self.reached, self.spent)
        own = {
            "numbers": np.array(numbers, dtype=float), "outside": np.array(self.outside),
            "state": np.array([self.h, self.q]), "before": np.array(self.before),
            "dts": np.array(self.dts), "times": np.array(self.times), "states": np.array(self.states),
        }  # fmt: skip
        kept = under("loop", own) | under("awake", self.awake.kept()) | under("ledger", self.ledger.kept())
        if self.stepper.density:
            kept |= under("density", self.stepper.density.kept())
        if self.causes:
            kept |= under("causes", self.causes.kept())
        for recorder in self.recorders:
            kept |= under(f"dump {recorder.dump.name}", recorder.kept())
        return kept

    def restore(self, kept: Kept) -> None:
        """Stand where `kept` was told."""
        own = part("loop", kept)
        step, self.t, still, self.fastest, self.first_reach, self.reached, spent = own["numbers"].tolist()
        self.began = time.perf_counter() - spent
        self.step, self.still, self.outside = int(step), int(still), str(own["outside"])
        self.h[:], self.q[:] = own["state"]
        self.before[0][:], self.before[1][:] = own["before"]
        self.dts, self.times = own["dts"].tolist(), own["times"].tolist()
        self.states = [(h, q) for h, q in own["states"]]
        self.awake.restore(part("awake", kept))
        self.ledger.restore(part("ledger", kept))
        if self.stepper.density:
            self.stepper.density.restore(part("density", kept))
        if self.causes:
            self.causes.restore(part("causes", kept))
        for recorder in self.recorders:
            recorder.restore(part(f"dump {recorder.dump.name}", kept))

    @property
    def spent(self) -> float:
        """Seconds in the time loop so far."""
        return time.perf_counter() - self.began

    def finish(self, verdict: Verdict) -> Run:
        """The run as a value; the last good state is its last row."""
        wall_time = self.spent
        if self.times[-1] != self.t:
            self.stepper.begin(*self.before)  # once more, for f may belong to a step that was given up
            self.stepper.advance(self.dts[-1])
            self.ledger.save(self.h, self.q)
            self._save()
        return Run(
            scene=self.scene, method=self.method, clock=self.clock, t=np.array(self.times),
            h=np.array([h for h, _ in self.states]), q=np.array([q for _, q in self.states]),
            dt=np.array(self.dts), verdict=verdict, wall_time=wall_time, entries=self.ledger.columns(),
            awake=self.awake.cell_steps / (self.step * self.h.size) if self.step else 1.0,
            dumps={recorder.dump.name: recorder.result() for recorder in self.recorders},
            causes=self.causes.result() if self.causes else None,
        )  # fmt: skip

    def _cut(self, density: Density | None, reach: float) -> float | None:
        """The mass of M outside the window, per dx; None if the run is to stop because of it."""
        if density is None or reach <= density.grid.bound * (1.0 + ROUNDING):
            return 0.0
        bound = density.grid.bound
        self.outside = (
            f"velocities reach {reach:.4g}, outside the window of {bound:.4g} (take a bound of {1.05 * reach:.3g})"
        )
        velocity = self.method.velocity if isinstance(self.method, Kinetic) else None
        stops = isinstance(velocity, Uniform) and velocity.beyond == "stop"
        return None if stops else density.cut(self.stepper.now)

    def _accept(self, h1: Array, q1: Array, dt: float, after: float) -> bool:
        """Take over a good step; says whether it is the last one."""
        last = self.clock.next_dt(self.step + 1, after, 0.0, 1.0) is None
        for recorder in self.recorders:
            recorder.record(self.stepper.now, self.step + 1, self.t, after, last)
        if self.causes:
            self.causes.note(h1, q1, dt)
        self.before, (self.h, self.q) = (self.h, self.q), self.before
        self.h[:], self.q[:] = h1, q1
        self.step, self.t = self.step + 1, after
        self.dts.append(dt)
        return last

    def _same_length(self) -> float | None:
        """The length of all steps, if there is one and nobody looks into the density, so that cells may sleep."""
        watched = self.recorders or self.causes
        return self.clock.dt if isinstance(self.clock, Fixed) and self.awake.sleeps and not watched else None

    def _unseen(self) -> bool:
        """Whether the coming step leaves no row, for which the whole density would be asked."""
        return (self.step + 1) % self.save_every != 0 and self.clock.next_dt(self.step + 1, 0.0, 0.0, 1.0) is not None

    def _settled(self, h1: Array, q1: Array, h_max: float) -> bool:
        """Whether a step changed nothing of a mass without motion; what only rounding moves must do so for a while."""
        if np.array_equal(h1, self.h) and np.array_equal(q1, self.q):
            return True
        return self.still >= REST_STEPS and float(np.max(np.abs(h1 - self.h))) <= ROUNDING * h_max

    def _end(self) -> Verdict:
        if self.still >= REST_STEPS:
            return self.verdict("at-rest", "at rest")
        return self.verdict("finished", "finished")

    def _warm_up(self) -> None:
        """Take a step that nobody keeps, so that compiling does not count as running."""
        self.stepper.begin(self.h, self.q)
        self.stepper.advance(1e-3 * self.scene.cells.dx)
        self.first_reach = self.reached = self.stepper.reach()

    def _foresee(self) -> None:
        """Refuse a run whose rows will not fit; with a `Courant` clock as its first step lets foresee."""
        steps = self.clock.steps_at(max(self.fastest, self.falling), self.scene.cells.dx)
        kept = self.foreseen = math.ceil(steps / self.save_every) + 1
        require_history(kept, steps, self.h.size, f"{kept} rows and {steps} steps")

    def _ask_for_rows(self) -> None:
        """Refuse rows that nobody foresaw and that will not fit."""
        more = len(self.states)
        if more > self.foreseen and more & (more - 1) == 0:  # twice as many may come before the next look
            require_history(more, self.step, self.h.size, f"{more} rows more")

    def _save(self) -> None:
        self.times.append(self.t)
        self.states.append((self.h.copy(), self.q.copy()))
        if self.causes:
            self.causes.save(self.t, self.h, self.q)


def _on_its_own(scene: Scene) -> Scene:
    """The scene, with what it reads from files as values of its own."""
    if isinstance(scene.chute, SmoothChute) and isinstance(scene.chute.zeta, SlopeTable):
        scene = replace(scene, chute=replace(scene.chute, zeta=scene.chute.zeta.points()))
    if not isinstance(scene.heap, Table):
        return scene
    h, u = scene.heap(scene.x)
    return replace(scene, heap=Profile(h, u))


def _falling(scene: Scene, clock: AnyClock) -> float:
    """The speed that keeps a grain which starts to slide from passing more cells than the Courant number in a step."""
    drive = max(float(np.max(np.abs(scene.pull) - scene.resistance)), 0.0)
    return math.sqrt(0.5 * clock.number * scene.cells.dx * drive) if isinstance(clock, Courant) else 0.0


def over_the_bound(dt: float, speed: float, dx: float, clock: AnyClock, limit: float) -> str:
    """That a step breaks the CFL bound, and what does not."""
    allowed, courant = limit * dx / speed, speed * dt / dx
    remedy = f"take dt <= {allowed:.4g}" if isinstance(clock, Fixed) else f"take a Courant number of at most {limit:g}"
    bound = "the CFL bound (28)" if limit == 1.0 else f"the CFL bound of order 2, {limit:g}"
    return f"dt = {dt:.4g} breaks {bound}: Courant number {courant:.4g}; {remedy}"
