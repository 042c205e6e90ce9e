"""Take up a run that was put down."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from .checkpoint import Checkpoint, Keeper, Kept, read_checkpoint
from .clock import Courant, Fixed, Replay
from .diagnostics.dump import Dump
from .diagnostics.history import Cadence
from .errors import InputError
from .method import Kinetic, Macroscopic
from .run import Run, description
from .scene import Scene
from .simulation import Progress, Simulation

KINDS: dict[str, Any] = {
    "scene": Scene, "method": Kinetic | Macroscopic, "clock": Fixed | Courant | Replay, "dumps": list[Dump],
    "cadence": dict[str, Any], "force": bool, "causes": bool, "observers": list[str], "every": float,
}  # fmt: skip


@np.errstate(all="ignore")
def resume(
    path: str | Path,
    *,
    scene: Scene | None = None,
    method: Kinetic | Macroscopic | None = None,
    observers: Sequence[Any] = (),
    progress: Progress | None = None,
) -> Run:
    """Go on with a run that was put down in the file `path`, to the very bits it would have come to without a stop.

    It is put down in the same file again, as often as before.

    Args:
        path: A file that `simulate` with a `Checkpoint` has written.
        scene, method: The same as before, where they have parts that no file can hold, such as a function.
        observers: The same as before, if there were any.
        progress: As in `simulate`.

    Returns:
        The whole run, as if it had not been stopped; `wall_time` counts the steps whose results it has.

    Raises:
        InputError: The file is not there, is damaged or no checkpoint, or was written by another version; or what is
            given is not what was run.
    """
    about, kept = _read(path)
    given = {name: part for name, part in (("scene", scene), ("method", method)) if part is not None}
    request = _request(path, about, given)
    try:
        cadence = Cadence(
            request["clock"], **{name: request["cadence"].get(name) for name in ("save_every", "save_at", "rows")}
        )
        simulation = Simulation(
            request["scene"], request["method"], request["clock"], cadence, request["force"],
            request["dumps"], request["causes"], observers,
        )  # fmt: skip
        names = [observer.name for observer in simulation.own]
        if names != request["observers"]:
            raise InputError(f"{path}: was run with the observers {request['observers']}, and {names} are given")
        simulation.solver.warm_up()
        simulation.restore(kept)
    except (KeyError, ValueError, TypeError, IndexError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: is no checkpoint that kinsim wrote; run from the start") from None
    simulation.keeper = Keeper(Checkpoint(str(path), request["every"]), simulation.about())
    return simulation.run(progress)


def read_request(path: str | Path) -> dict[str, Any]:
    """What the run in the file `path` is, by the names in `KINDS`.

    Raises:
        InputError: As in `resume`.
    """
    return _request(path, _read(path)[0], {})


def _read(path: str | Path) -> tuple[dict[str, Any], Kept]:
    about, kept = read_checkpoint(path)
    if about.get("version") != version("kinsim"):
        raise InputError(
            f"{path}: was written by kinsim {about.get('version')}, this is {version('kinsim')}; take that version"
        )
    return about, kept


def _request(path: str | Path, about: dict[str, Any], given: dict[str, Any]) -> dict[str, Any]:
    """The values that are described, but for those that are given and have the same description."""
    for name, part in given.items():
        described = description(*(given.get(key, Fixed(1.0, 1)) for key in ("scene", "method", "clock")))[name]
        if described != about.get(name):
            raise InputError(f"{path}: was run with another {name} than is given: {type(part).__name__}; give the same")
    try:
        return {
            name: given[name] if name in given else TypeAdapter(kind).validate_python(about[name])
            for name, kind in KINDS.items()
        }
    except ValidationError as error:
        if "outside" in str(about):
            raise InputError(f"{path}: has parts that no file can hold; give the same scene and method again") from None
        raise InputError(f"{path}: {error.errors()[0]['msg']}") from None
    except KeyError as missing:
        raise InputError(
            f"{path}: is no checkpoint that kinsim wrote, it has no {missing}; run from the start"
        ) from None
