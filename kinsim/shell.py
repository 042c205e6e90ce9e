"""What all commands share: how input is named and read, and how bad input is told."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .errors import NO_MEMORY, InputError
from .interrupt import terminable

if TYPE_CHECKING:
    from .read import SceneFile


class MethodKind(StrEnum):
    """The two wings."""

    KINETIC = "kinetic"
    MACROSCOPIC = "macroscopic"


SCENE = typer.Argument(metavar="NAME|FILE", help="A built-in scene (see: kinsim scenes), or a scene file.")
SceneName = Annotated[str, SCENE]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key, for example friction.delta=pi/12; may be repeated."),
]
Force = Annotated[bool, typer.Option("--force", help="Run although the CFL bound is broken.")]

Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but faults.")]

EXIT_CODES = {"finished": 0, "at-rest": 0, "interrupted": 130}
"""By verdict; 1 for a run that was stopped. Bad input is 2."""


@contextmanager
def told() -> Iterator[None]:
    """Bad input is told in one line, without a traceback, and so are Ctrl-C and SIGTERM."""
    try:
        with terminable():
            yield
    except InputError as error:
        complain(str(error), 2)
    except MemoryError:
        complain(NO_MEMORY, 2)
    except KeyboardInterrupt as interrupt:
        complain(f"interrupted; {str(interrupt) or 'nothing was written'}", 130)


@contextmanager
def resumable(folder: Path | None) -> Iterator[None]:
    """An interrupt between two members says, too, where finished ones are; `folder` is None where none are kept."""
    try:
        yield
    except KeyboardInterrupt as interrupt:
        where = f"finished members are kept in {folder}; --resume does the rest" if folder else ""
        raise KeyboardInterrupt(str(interrupt) or where) from None


def complain(line: str, code: int) -> None:
    """Say one line on the error stream, and end."""
    typer.echo(" ".join(line.split()), err=True)
    raise typer.Exit(code)


def read_scene(name: str, settings: list[str] | None, method: MethodKind | None) -> SceneFile:
    """The scene called `name`, with the settings and the wing that were asked for."""
    from .read import change, check, read_keys, take_method

    keys = read_keys(name)
    change(keys, settings or [])
    if method:
        take_method(keys, method.value)
    return check(keys, name)


def keep_apart(*names: str | Path | None) -> None:
    """No file is written over another one, nor over the scene itself."""
    places = [Path(name).resolve() for name in names if name]
    for place in places:
        if places.count(place) > 1:
            raise InputError(f"{place}: is named twice; each file needs a name of its own")
