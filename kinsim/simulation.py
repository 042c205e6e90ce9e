"""A run under way: its solver, and what looks at it between blocks of steps."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np
from pydantic import TypeAdapter

from .checkpoint import Keeper, Kept, part, under
from .clock import AnyClock
from .diagnostics.causes import Causes
from .diagnostics.dump import Dump, recorders, require_density
from .diagnostics.endings import LIFTED_WORDS, Verdict, ending, verdict
from .diagnostics.history import Cadence, History
from .diagnostics.ledger import Ledger
from .diagnostics.lift import note_lift
from .diagnostics.observer import Observer, adopt
from .errors import InputError
from .interrupt import Deferred
from .method import Kinetic, Macroscopic
from .run import Run, description
from .scene import Scene, self_contained
from .solver.asked import falling
from .solver.march import SWEPT
from .solver.solver import Block, Solver

Progress = Callable[[float], None]

LOOK = 0.1
"""Seconds of work after which a block of steps ends, so that somebody may look."""


class Simulation:
    """The moving parts of a run: a solver, and what looks at it between its blocks.

    Attributes:
        verdict: How it ended, once it has.
    """

    def __init__(
        self, scene: Scene, method: Kinetic | Macroscopic, clock: AnyClock, cadence: Cadence, force: bool = False,
        dumps: Sequence[Dump] = (), causes: bool = False, observers: Sequence[Any] = (),
    ) -> None:  # fmt: skip
        self.scene, self.method, self.clock, self.cadence, self.force = scene, method, clock, cadence, force
        self.dumps = recorders(dumps, scene, method, clock)
        self.causes = Causes(scene, require_density(method).order) if causes else None
        self.history = History(cadence, Ledger(scene, method), self.causes)
        self.own = adopt(observers)
        self.observers: list[Observer] = [*([self.causes] if self.causes else []), self.history, *self.dumps, *self.own]
        self.solver = Solver(scene, method, force)
        self.keeper: Keeper | None = None
        self.verdict: Verdict | None = None
        self.dts: list[np.ndarray] = []
        self.began, self._pace, self.longest = time.perf_counter(), 0.0, 0.0

    def start(self) -> None:
        """Show the initial state to all observers; from now on time counts."""
        solver, clock = self.solver, self.clock
        steps = clock.steps_at(max(self.scene.fastest, falling(self.scene, clock.number)), self.scene.cells.dx)
        self.history.foresee(steps, self.scene.cells.count)
        lifted = note_lift(self.scene, solver.h, solver.q, solver.seen)
        solver.warm_up()
        self.began = time.perf_counter()
        for observer in self.observers:
            observer.start(solver)
        self._hear()
        if lifted and self.scene.chute.lifting == "stop":  # type: ignore[union-attr]
            self.verdict = verdict("lifted-off", LIFTED_WORDS, solver, self.history.ledger)

    def run(self, progress: Progress | None = None) -> Run:
        """Go on to the end, or until somebody stops it."""
        try:
            with Deferred() as interrupt:
                while self.verdict is None and not interrupt.asked:
                    self.advance()
                    if self.keeper and self.verdict is None:
                        self.keeper.look(self.kept)
                    if progress:
                        progress(min(self.solver.t / self.clock.end, 1.0) if self.clock.end else 1.0)
        except KeyboardInterrupt:
            pass
        if self.verdict is None:
            self.verdict = verdict("interrupted", "interrupted", self.solver, self.history.ledger)
        if self.keeper and self.verdict.kind in ("interrupted", "observer-failed", "stopped"):
            self.keeper.put_down(self.kept())
        return self.finish()

    def advance(self, most: float = math.inf) -> None:
        """Take a block of at most `most` steps, and show it.

        Raises:
            InputError: The first step cannot be taken.
        """
        try:
            block = self.block(most)
        except InputError as error:
            if self.solver.step == 0:
                raise
            self.verdict = verdict("refused", f"{error}; stopped", self.solver, self.history.ledger)
            return
        self.dts.append(block.dts)
        stop = ""
        for observer in self.observers if block.dts.size else ():
            try:
                said = observer.look(block)
            except InputError as error:  # a row more does not fit
                self.verdict = verdict("refused", f"{error}; stopped", self.solver, self.history.ledger)
                continue
            stop = f"stopped by {observer.name!r}: {said}" if said and not stop else stop
        self.conclude(block)
        if stop and self.verdict is None:
            self.verdict = verdict("stopped", stop, self.solver, self.history.ledger)
        self._hear()

    def _hear(self) -> None:
        """End the run if an observer of somebody's own has failed; it keeps all that it has."""
        if self._failure and self.verdict is None:
            self.verdict = verdict("observer-failed", f"{self._failure}; stopped", self.solver, self.history.ledger)

    @property
    def _failure(self) -> str:
        """What an observer of somebody's own has raised first, in words, or nothing."""
        return next((observer.failure for observer in self.own if observer.failure), "")

    def block(self, most: float = math.inf) -> Block:
        """A block of steps up to where somebody wants to look."""
        solver, clock, step, t = self.solver, self.clock, self.solver.step, self.solver.t
        look = min(observer.next_step(step) for observer in self.observers) - step
        paced = max(int(LOOK / self._pace), 1) if self._pace else 16
        until = min(observer.next_time(t) for observer in self.observers)
        past = min(observer.next_past(t) for observer in self.observers)
        began = time.perf_counter()
        block = solver.march(clock, int(max(min(most, look, paced, clock.most - step), 1)), until, past)
        if block.dts.size:
            self._pace = (time.perf_counter() - began) / block.dts.size
        return block

    def conclude(self, block: Block) -> None:
        """The verdict, if the run ends with a block.

        Raises:
            InputError: Its first step would break the CFL bound.
        """
        end = ending(block, self.clock)
        if end is None or self.verdict is not None:
            return
        kind, words, cell = end
        if kind == "cfl-broken" and block.step == 0:
            raise InputError(words.removesuffix("; stopped"))
        self.verdict = verdict(kind, words, self.solver, self.history.ledger, cell)

    def finish(self) -> Run:
        """The run as a value; the last good state is its last row."""
        wall_time = time.perf_counter() - self.began
        solver, history = self.solver, self.history
        if history.times[-1] != solver.t:
            history.save(Block.now(solver))
        assert self.verdict is not None
        trouble = self.keeper.trouble if self.keeper else ""
        ended = replace(self.verdict, message=f"{self.verdict.message}; {trouble}") if trouble else self.verdict
        cells = solver.step * self.scene.cells.count
        observed = {observer.name: observer.result() for observer in self.own}
        if self._failure and ended.kind != "observer-failed":
            ended = replace(ended, message=f"{ended.message}; {self._failure}")
        return Run(
            scene=self.scene, method=self.method, clock=self.clock, t=np.array(history.times),
            h=np.array([h for h, _ in history.states]), q=np.array([q for _, q in history.states]),
            dt=np.concatenate([np.empty(0), *self.dts]), verdict=ended, wall_time=wall_time,
            entries=history.ledger.columns(), awake=float(solver.seen[SWEPT]) / cells if cells else 1.0,
            dumps={recorder.dump.name: recorder.result() for recorder in self.dumps},
            causes=self.causes.result() if self.causes else None,
            observed=observed,
        )  # fmt: skip

    def about(self) -> dict[str, Any]:
        """What is run, and what is asked of it."""
        dumps = [TypeAdapter(Dump).dump_python(recorder.dump, mode="json") for recorder in self.dumps]
        return {
            "version": version("kinsim"), **description(self_contained(self.scene), self.method, self.clock),
            "dumps": dumps, "cadence": self.cadence.asked, "force": self.force, "causes": self.causes is not None,
            "observers": [observer.name for observer in self.own],
        }  # fmt: skip

    def kept(self) -> Kept:
        """All that the next step depends on, and all that was kept so far."""
        spent = np.array(time.perf_counter() - self.began)
        own = {"dts": np.concatenate([np.empty(0), *self.dts]), "spent": spent, **self.solver.kept()}
        kept = under("loop", own)
        for number, observer in enumerate(self.observers):
            kept |= under(f"observer {number}", observer.kept())
        return kept

    def restore(self, kept: Kept) -> None:
        """Stand where `kept` was told."""
        own = part("loop", kept)
        self.began = time.perf_counter() - float(own["spent"])
        self.dts = [own["dts"]]
        self.solver.restore(own)
        for number, observer in enumerate(self.observers):
            observer.restore(part(f"observer {number}", kept))
