"""Does a changed kinsim still give the numbers of an old one? Hundreds of small runs and single steps, compared.

    python benchmarks/against_old.py record OUT.npz [--only SUBSTRING]   runs the cases with the kinsim that is imported
    python benchmarks/against_old.py compare OLD.npz NEW.npz             what differs, relative to its natural scale

Only the public interface of kinsim is used. To record another checkout, put it first: PYTHONPATH=CHECKOUT.
"""

from __future__ import annotations

import argparse
import sys
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field, fields, is_dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

import kinsim as ks

Array = NDArray[Any]
Recorded = dict[str, Array]
Keys = dict[str, Any]

GROUNDS = {"flat": (0.0, 0.3), "below": (0.2, 0.4), "above": (0.6, 0.3), "free": (0.0, None), "back-below": (-0.2, 0.4),
           "back-above": (-0.5, 0.2), "slip": (0.4, None)}  # fmt: skip
"""zeta and delta of constant slopes: below or above the angle of friction, "back" where they fall to -x."""

ENDS: Keys = {
    "periodic": "periodic", "wall": "wall", "open": "open", "wall-open": ("wall", "open"),
    "stream-open": (ks.Inflow(0.3, 2.0), "open"), "open-stream": ("open", ks.Inflow(0.3, -2.0)),
    "streams": (ks.Inflow(0.4, 0.3), ks.Inflow(0.2, -0.5)), "wall-stream": ("wall", ks.Inflow(0.5, -0.1)),
}  # fmt: skip
SCHEMES: dict[str, Keys] = {
    "scheme1": {"scheme": 1}, "scheme2": {"scheme": 2}, "scheme3-cell": {"scheme": 3},
    "scheme3-face": {"scheme": 3, "coupling": "face"}, "scheme4/hold": {}, "scheme4/reflect": {"statics": "reflect"},
    **{f"scheme4/{limiter}": {"order": 2, "limiter": limiter} for limiter in ("minmod", "between", "mc")},
}  # fmt: skip
SOME = ("scheme1", "scheme3-cell", "scheme4/hold", "scheme4/reflect", "scheme4/mc")
VELOCITIES = {"closed": None, "fitted6": ks.Fitted(6), "grid32": ks.Uniform(32), "window": ks.Window(0.1)}
METHODS = [(how, wing) for how, wing in product(SCHEMES, VELOCITIES) if wing != "window" or "order" not in SCHEMES[how]]
SLOPES = {
    "bend": ks.Bend(0.6, 0.0, 1.0, 2.0), "exponential": ks.Exponential(0.9, 1.5), "crest": ks.Crest(0.1, 0.9, 1.2, 0.3),
    "bowl": ks.Bowl(0.5, 1.5, 0.6), "arc": ks.Arc(5.0, 0.2, 1.5), "hill": ks.Arc(-4.0, 0.1, 1.5),
    "formula": ks.SlopeFormula("0.35*sin(2*pi*x/3)", 3.0),
    "points": ks.SlopePoints(tuple(0.5 * k for k in range(7)), (0.6, 0.55, 0.4, 0.3, 0.1, 0.0, -0.05), smoothing=0.01),
}  # fmt: skip
SCENES = "bend bend-pressed crest exponential jump parabola rest-gallery riemann silo silo-incline sine"
PILES = {"pile": (0.999, 0.0), "wet pile": (0.999, 0.1), "slump": (1.3, 0.0), "wet slump": (1.3, 0.1)}
"""How steep they are beside what friction holds, and how high the ground is covered beside them."""
EQUILIBRIA = ("cell-average", "sampled", "matched", "entropic")
FORCES = ("shift-linear", "shift-exact", "shift-pfc", "derivative-upwind", "derivative-centred")
CLOCKS = ("fixed", "courant", "fixed-rest", "courant-rest")

UNITS = {
    "h": "h h1 h_left h_right h_min", "u": "u u_left u_right u_max xi offset", "q": "q q1 qhat impulse of_mass",
    "qu": "of_momentum", "f": "M f_force f_transport f_equilibrium f_held f_min", "1": "residual",
    "momentum": "momentum sampling_momentum",
    "mass": "mass inflow_left inflow_right coupling_drift window_loss mended held sampling_mass f_distance f_tail",
}  # fmt: skip
"""The scale of a case that measures a quantity where it is larger than all values of it; others have only their own."""
UNIT = {quantity: unit for unit, quantities in UNITS.items() for quantity in quantities.split()}


@dataclass(frozen=True)
class Case:
    """A run, or with the clock "step" a single step; nothing is made before it is recorded."""

    name: str
    method: Keys
    velocity: ks.Uniform | ks.Window | ks.Fitted | None = None
    state: str = "wild"
    ground: str = "below"
    ends: str = "wall-open"
    clock: str = "fixed"
    steps: int = 40
    count: int = 60
    chute: ks.SmoothChute | None = None
    share: float = 0.5  # of the longest step that the CFL bound allows
    dumps: tuple[str, ...] = ("force",)
    more: Keys = field(default_factory=dict)

    def setting(self) -> tuple[ks.Scene, ks.Macroscopic | ks.Kinetic, float, ks.Fixed | ks.Courant]:
        """Scene, method, length of a step and clock."""
        method = ks.Kinetic(velocity=self.velocity, **self.method) if self.velocity else ks.Macroscopic(**self.method)
        zeta, delta = GROUNDS[self.ground]
        h, u = self.mass()
        scene = ks.Scene(
            ks.Cells(0.0, 0.05 * self.count, self.count), ks.Profile(h, u), self.chute or ks.ConstantSlope(zeta),
            ks.Frictionless() if delta is None else ks.Coulomb(delta), ENDS[self.ends], epsilon=0.4,
        )  # fmt: skip
        streams = [end for end in ENDS[self.ends] if isinstance(end, ks.Inflow)]
        fastest = max([np.max(np.abs(u) + np.sqrt(0.8 * h)), *(abs(end.u) + np.sqrt(0.8 * end.h) for end in streams)])
        dt, rest = float(self.share / method.order * 0.05 / fastest), self.clock.endswith("rest")
        if not self.clock.startswith("courant"):
            return scene, method, dt, ks.Fixed(dt, self.steps, stop_at_rest=rest)
        end, most = self.steps * dt, 2 * self.steps
        return scene, method, dt, ks.Courant(0.9 / method.order, end, stop_at_rest=rest, most=most)

    def mass(self) -> tuple[Array, Array]:
        """Heights and velocities; what is random depends on the name of the case alone."""
        x, middle = 0.05 * (np.arange(self.count) + 0.5), 0.025 * self.count
        if self.state in PILES:
            pull, hold = (np.tan(angle or 0.0) for angle in GROUNDS[self.ground])
            share, floor = PILES[self.state]
            flanks = [share / 0.4 * steep * (x - middle) for steep in (pull + hold, pull - hold)]
            return np.maximum(0.6 + np.minimum(*flanks), floor), np.zeros(self.count)
        if self.state == "blocks":
            return np.where(np.abs(x - middle) < 0.2 * middle, 1.0, 0.2), np.where(x < middle, 0.3, 0.0)
        if self.state == "heap":
            h = np.maximum(0.8 - (2.0 * (x - middle) / middle) ** 2, 0.0)
            return h, np.where(h > 0.0, 0.4, 0.0)
        rng = np.random.default_rng(zlib.crc32(self.name.encode()))
        if self.state == "wet":
            return 0.5 + 0.3 * np.sin(x) + 0.05 * rng.random(self.count), 0.2 + 0.2 * rng.random(self.count)
        h = 10.0 ** rng.uniform(-2.0, 0.0, self.count)
        if self.state == "films":
            h[rng.random(self.count) < 0.3] = 1e-12
            h[rng.random(self.count) < 0.3] = 1e-300
        u = rng.uniform(-1.2, 1.2, self.count) * np.sqrt(0.8 * h)
        u[::7] = h[::11] = u[::11] = 0.0
        return h, u

    def record(self) -> Recorded:
        """All that the run or the step leaves behind, and how large it can be."""
        scene, method, dt, clock = self.setting()
        if self.clock == "step":
            h, q = scene.initial()
            return flattened("", ks.step(scene, method, h, q, dt)) | scales(scene, h, q)
        gridded = isinstance(method, ks.Kinetic) and not isinstance(method.velocity, ks.Fitted)
        dumps = [ks.Dump(f"f_{stage}", stage, every=10**6) for stage in self.dumps if gridded]  # type: ignore[arg-type]
        run = ks.simulate(scene, method, clock, save_every=8, dumps=dumps, **self.more)
        found = {name: np.array(getattr(run, name)) for name in ("t", "h", "q", "dt")}
        found |= {f"ledger.{name}": np.array(column) for name, column in run.entries.items()}
        found |= {"verdict": np.array(run.verdict.kind), "verdict.step": np.array(run.verdict.step)}
        for name, dump in run.dumps.items():
            found |= {name: dump.to_numpy(), **{f"{name}.{axis}": dump[axis].to_numpy() for axis in dump.coords}}
        causes = {} if run.causes is None else {f"causes.{name}": part.to_numpy() for name, part in run.causes.items()}
        return found | causes | scales(scene, run.h, run.q)


class BuiltIn(Case):
    """The built-in scene named as `state`, on a third of its cells, with few steps."""

    def setting(self) -> tuple[ks.Scene, ks.Macroscopic | ks.Kinetic, float, ks.Fixed | ks.Courant]:
        """Scene, method, length of a step and clock; without keys of its own the method is that of the scene."""
        scene, own, clock = ks.load_scene(self.state)
        scene = replace(scene, cells=replace(scene.cells, count=scene.cells.count // 3))
        keys = self.method or {"scheme": own.scheme, "coupling": own.coupling, "statics": own.statics}
        method = ks.Kinetic(velocity=self.velocity, **keys) if self.velocity else ks.Macroscopic(**keys)
        if isinstance(clock, ks.Fixed):
            return scene, method, 0.0, replace(clock, dt=10 * clock.dt / method.order, steps=40)
        return scene, method, 0.0, replace(clock, number=0.9 / method.order, end=min(clock.end, 6.0), most=60)


def flattened(name: str, thing: Any) -> Recorded:
    """All arrays and numbers in a value, by their names in it; first and second moments apart, as their scales are."""
    if thing is None:
        return {}
    if is_dataclass(thing) or hasattr(thing, "_fields"):
        names = thing._fields if hasattr(thing, "_fields") else [part.name for part in fields(thing)]
        parts = [flattened(f"{name}.{part}" if name else part, getattr(thing, part)) for part in names]
        return {key: array for part in parts for key, array in part.items()}
    if name in ("flux", "balanced_flux", "half"):
        return {f"{name}.of_mass": np.array(thing[::2]), f"{name}.of_momentum": np.array(thing[1::2])}
    return {name: np.array(thing)}


@np.errstate(all="ignore")
def scales(scene: ks.Scene, h: Array, q: Array) -> Recorded:
    """How large h, u, q, f and so on are where they are largest."""
    beta, dx = scene.epsilon * scene.k, scene.cells.dx
    c = np.sqrt(2.0 * beta * np.abs(h))
    fast = np.abs(q / np.where(h > 0.0, h, 1.0)) + c
    found = {"h": h, "u": fast, "q": h * fast, "qu": h * fast**2, "f": c / (np.pi * beta), "1": np.ones(1),
             "mass": h.sum(axis=-1) * dx, "momentum": (h * fast).sum(axis=-1) * dx}  # fmt: skip
    return {f"scale {name}": np.max(np.abs(np.nan_to_num(array))) for name, array in found.items()}


def cases() -> Iterator[Case]:
    """All cases; grounds, ends and clocks take turns in steps that meet all methods."""
    grounds, ends, states = list(GROUNDS), list(ENDS), ("wild", "heap", "films", "blocks")
    balanced = ("scheme2", "scheme3-cell", "scheme3-face")  # velocities of these run away at the rim of dry ground
    for at, (kind, (how, wing), state) in enumerate(product(("step", "run", "hidden"), METHODS, ("wild", "films"))):
        ground, end = grounds[(at + at // 7) % 7], ends[(3 * at + at // 8) % 8]
        if how in balanced and state == "films" and (kind != "step" or wing in ("grid32", "window")):
            state = "wet"
        elif kind == "hidden":  # tiles at rest are not swept where nobody looks into f
            state = "blocks" if state == "wild" else "heap"
        clock, dumps = "step" if kind == "step" else CLOCKS[(at + at // 4) % 4], () if kind == "hidden" else ("force",)
        name = "/".join((kind, ground, how, wing, state, end, clock))
        yield Case(name, SCHEMES[how], VELOCITIES[wing], state, ground, end, clock, dumps=dumps)
    for (how, wing), ground, pile in product(METHODS, ("flat", "below", "back-below"), ("pile", "slump")):
        if how in ("scheme2", "scheme3-cell", *SOME[2:]) and (ground == "below" or wing == "closed"):
            state, clock = "wet " * (how in balanced) + pile, "fixed" if wing == "fitted6" else "fixed-rest"
            keys = {"clock": clock, "count": 100, "steps": 150 if pile == "slump" else 20, "dumps": ()}
            yield Case(f"{pile}/{ground}/{how}/{wing}", SCHEMES[how], VELOCITIES[wing], state, ground, "wall", **keys)
    lengths = {256: ("wild", "streams", "fixed"), 257: ("wild", "periodic", "courant"), 300: ("heap", "wall", "fixed")}
    for (how, wing), count in product(METHODS, lengths):
        if how in ("scheme3-face", *SOME) and wing != "window":
            state, end, clock = ("wet" if how in balanced else lengths[count][0]), *lengths[count][1:]
            keys = {"count": count, "steps": 20, "dumps": ("force",) if wing == "grid32" and count == 257 else ()}
            if how in SOME[2:] and count > 256:
                chute = ks.SmoothChute(ks.SlopeFormula(f"0.35*sin(2*pi*x/{0.05 * count})", 3.0), eta=1.0)
                name = f"long/chute/{how}/{wing}/{count}"
                yield Case(name, SCHEMES[how], VELOCITIES[wing], state, "flat", end, clock, chute=chute, **keys)
            yield Case(f"long/{how}/{wing}/{count}", SCHEMES[how], VELOCITIES[wing], state, "below", end, clock, **keys)
    yield Case("long/scheme4/hold/closed/pile/700", {}, None, "pile", "flat", "wall", count=700)
    for (how, wing), share in product(METHODS, (1.3, 0.9)):
        if how in SOME and wing != "window":  # forced over the CFL bound, or close below it
            name, more = f"fast/{share}/{how}/{wing}", {"force": share > 1.0}
            yield Case(name, SCHEMES[how], VELOCITIES[wing], "heap", "above", "open", share=share, steps=15, more=more)
    yield Case("refused/over the CFL bound", {}, None, share=1.3)

    for at, (level, force, projection) in enumerate(product(EQUILIBRIA, FORCES, ("flux-difference", "re-summed"))):
        how = ("scheme4/hold", "scheme1", "scheme4/reflect", "scheme3-cell", "scheme2")[(at + at // 5) % 5]
        keys, nodes = {"equilibrium": level, "force": force}, ks.Uniform((16, 32, 64)[at // 2 % 3])
        name, given = f"grid/{level}/{force}/{projection}", {"clock": CLOCKS[at % 2], "count": 40, "steps": 20}
        first = {**keys, "projection": projection, **SCHEMES[how]}
        yield Case(f"{name}/{how}", first, nodes, states[at % 2], grounds[at % 4], ends[at % 5], **given)
        if projection == "flux-difference" and force != "shift-exact":
            second = {**keys, "order": 2, "limiter": ("minmod", "between", "mc")[at // 2 % 3]}
            yield Case(f"{name}/order2", second, nodes, states[at // 2 % 3], grounds[at % 7], ends[at % 5], **given)
    for bound, beyond, how in product((0.8, 4.0), ("stop", "warn"), ("scheme1", "scheme4/hold", "scheme4/between")):
        nodes = ks.Uniform(24, bound, beyond)  # type: ignore[arg-type]
        yield Case(f"grid/bound-{bound}/{beyond}/{how}", SCHEMES[how], nodes, "heap", "above", "open")
    for how in ("scheme1", "scheme3-cell", "scheme4/hold"):
        dumps = ("force", "transport", "equilibrium", *(("held",) if how == "scheme4/hold" else ()))
        yield Case(f"grid/causes/{how}", SCHEMES[how], ks.Uniform(32), dumps=dumps, more={"causes": True})
    for count, how in product((1, 2, 3, 8), SOME):
        yield Case(f"fitted{count}/{how}", SCHEMES[how], ks.Fitted(count), clock="courant")

    smooth = [(how, wing) for how, wing in METHODS if how in ("scheme4/hold", "scheme4/reflect", "scheme4/between")]
    for at, (slope, (how, wing)) in enumerate(product(SLOPES, smooth)):
        eta, end = (0.0, 1.0)[(at + at // 11) % 2], "periodic" if slope == "formula" and at % 2 else ends[1 + at % 7]
        chute = ks.SmoothChute(SLOPES[slope], eta, "stop" if at % 5 == 0 else "warn")
        name, clock = f"chute/{slope}/eta{eta:g}/{how}/{wing}", "step" if at % 6 == 0 else CLOCKS[at % 4]
        case = Case(name, SCHEMES[how], VELOCITIES[wing], states[at % 3], ("flat", "free")[at % 3 // 2], end, clock)
        yield replace(case, chute=chute, dumps=() if at % 4 == 2 else ("force",))
    for name, wing in product(SCENES.split(), ("own", "closed", "fitted", "order2")):
        velocity = {"own": ks.Uniform(32), "fitted": ks.Fitted(6)}.get(wing)
        method = {"fitted": {"scheme": 4}, "order2": {"order": 2}}.get(wing, {})
        yield BuiltIn(f"scene/{name}/{wing}", method, velocity, name)


def record(path: str, only: str) -> None:
    """Run all cases, and keep what they leave behind; a case that raises leaves its message."""
    chosen, kept, failed, began = [case for case in cases() if only in case.name], {}, 0, time.perf_counter()
    for at, case in enumerate(chosen):
        try:
            found = case.record()
        except Exception as error:  # whatever it is, the others go on
            found, failed = {"error": np.array(f"{type(error).__name__}: {error}")}, failed + 1
            print(f"\r{case.name}: {found['error']}")
        kept |= {f"{case.name}::{quantity}": array for quantity, array in found.items()}
        print(f"\r{at + 1} of {len(chosen)}, {time.perf_counter() - began:.0f} s", end="", flush=True)
    np.savez(path, **kept)
    print(f"\r{len(chosen)} cases of {ks.__file__} in {time.perf_counter() - began:.0f} s, {failed} raised: {path}")


def difference(quantity: str, old: Recorded, new: Recorded) -> float | None:
    """The largest difference over the scale of the quantity, inf where there is no such number; None if bits agree."""
    a, b = old.get(quantity), new.get(quantity)
    if a is None or b is None or a.shape != b.shape:
        return np.inf
    if a.dtype == b.dtype and a.tobytes() == b.tobytes():
        return None
    if a.dtype.kind not in "fiub" or b.dtype.kind not in "fiub":
        return np.inf
    a, b = a.astype(float), b.astype(float)
    unit = float(old.get(f"scale {UNIT.get(quantity.split('.')[-1])}", np.zeros(())))
    scale = max(unit, float(np.max(np.abs(a[np.isfinite(a)]), initial=0.0))) or 1.0
    with np.errstate(invalid="ignore"):
        off = np.where((a == b) | (np.isnan(a) & np.isnan(b)), 0.0, np.abs(a - b) / scale)
    return float(np.max(np.nan_to_num(off, nan=np.inf), initial=0.0))


def told(quantity: str, size: float, *sides: Recorded) -> str:
    """A difference in words."""
    parts = [found.get(quantity) for found in sides]
    words = ["none" if a is None else f"shape {a.shape}" if a.ndim else str(a) for a in parts]
    return f"{quantity} {size:.1e}" + (f" ({words[0]} -> {words[1]})" if size == np.inf else "")


def compare(old_path: str, new_path: str, only: str) -> bool:
    """Print what differs, case by case, and a summary; says whether all is within 1e-9."""
    old, new = by_case(old_path, only), by_case(new_path, only)
    sizes: dict[str, float] = {}
    for name in [name for name in old if name in new]:
        quantities = [key for key in old[name] | new[name] if not key.startswith("scale ")]
        found = {key: difference(key, old[name], new[name]) for key in quantities}
        worst = sorted(((size, key) for key, size in found.items() if size is not None), reverse=True)
        sizes[name] = worst[0][0] if worst else -1.0
        print(f"{name}: {', '.join(told(key, size, old[name], new[name]) for size, key in worst) or 'bits'}")
    print(f"\n{len(sizes)} cases in both: {sum(size < 0.0 for size in sizes.values())} with equal bits")
    for bound in (1e-13, 1e-9):
        print(f"  {sum(size <= bound for size in sizes.values())} within {bound:g}, those before included")
    for size, name in sorted(((size, name) for name, size in sizes.items() if not size <= 1e-9), reverse=True):
        print(f"  {size:.1e} {name}")
    for what, here, there in (("missing", old, new), ("extra", new, old)):
        print(f"{what}: {', '.join(name for name in here if name not in there) or 'none'}")
    for what, those in (("old", old), ("new", new)):
        raised = [f"\n  {name}: {found['error']}" for name, found in those.items() if "error" in found]
        print(f"raised in {what}: {len(raised)}{''.join(raised)}")
    return old.keys() == new.keys() and all(size <= 1e-9 for size in sizes.values())


def by_case(path: str, only: str) -> dict[str, Recorded]:
    """What a file holds, by case and quantity."""
    found: dict[str, Recorded] = {}
    with np.load(path) as stored:
        for key in stored.files:
            name, _, quantity = key.partition("::")
            if only in name:
                found.setdefault(name, {})[quantity] = stored[key]
    return found


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("record", "compare"))
    parser.add_argument("files", nargs="+", metavar="FILE.npz", help="one to record, two to compare")
    parser.add_argument("--only", default="", metavar="SUBSTRING", help="only cases with this in their name")
    given = parser.parse_args()
    if len(given.files) != {"record": 1, "compare": 2}[given.what]:
        parser.error("record takes one file, compare two")
    if given.what == "record":
        record(*given.files, given.only)
    elif not compare(*given.files, given.only):
        sys.exit(1)


if __name__ == "__main__":
    main()
