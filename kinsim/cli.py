"""The command line. Only what ``--help`` needs is imported here; each command imports its own."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .errors import InputError

if TYPE_CHECKING:
    from .read import SceneFile
    from .watch.dump import Dump

app = typer.Typer(
    help="Run the Savage-Hutter equations with a particle density f(x, xi), or with its closed-form twin.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


class MethodKind(StrEnum):
    """The two wings."""

    KINETIC = "kinetic"
    MACROSCOPIC = "macroscopic"


SceneName = Annotated[
    str, typer.Argument(metavar="NAME|FILE", help="A built-in scene (see: kinsim scenes), or a scene file.")
]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change a key, for example friction.delta=pi/12; may be repeated."),
]
Force = Annotated[bool, typer.Option("--force", help="Run although the CFL bound is broken.")]

EXIT_CODES = {"finished": 0, "at-rest": 0, "interrupted": 130}
"""By verdict; 1 for a run that was stopped. Bad input is 2."""


@contextmanager
def _told() -> Iterator[None]:
    """Bad input is told in one line, without a traceback."""
    try:
        yield
    except InputError as error:
        _complain(str(error), 2)
    except MemoryError:
        _complain("not enough memory; take fewer cells or velocity nodes", 2)
    except KeyboardInterrupt:
        _complain("interrupted; nothing was written", 130)


def _complain(line: str, code: int) -> None:
    typer.echo(" ".join(line.split()), err=True)
    raise typer.Exit(code)


def _version(wanted: bool) -> None:
    if wanted:
        from . import __version__

        typer.echo(f"kinsim {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass


@app.command()
@_told()
def scenes() -> None:
    """List the built-in scenes and their figures in the paper."""
    from .overview import scene_list
    from .read import built_in, read_keys

    scene_list({name: read_keys(path) for name, path in built_in().items()})


@app.command()
@_told()
def run(
    name: SceneName,
    method: Annotated[MethodKind | None, typer.Option(help="Take this wing instead of the one in the file.")] = None,
    settings: Settings = None,
    out: Annotated[Path | None, typer.Option(metavar="RUN.NC", help="Write the run to this netCDF file.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="RUN.PNG", help="Draw it: .png, .pdf or .svg.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but faults.")] = False,
    force: Force = False,
) -> None:
    """Run a scene, and say how it ended.

    Exit code: 0 if it went to its end, 1 if it was stopped, 2 if the input is bad, 130 if it was interrupted.
    """
    from .overview import saved_every
    from .plot import check_picture, plot_run
    from .progress import Watched
    from .report import run_report
    from .simulate import simulate
    from .store import check_destination

    file = _read(name, settings, method)
    if out:
        check_destination(out)
    if plot:
        check_picture(plot)
    with Watched(quiet) as progress:
        ran = simulate(
            file.scene,
            file.method,
            file.clock,
            saved_every(file),
            force=force,
            dumps=_final_density(file),
            progress=progress,
        )
    if out:
        ran.to_netcdf(out)
    if plot:
        plot_run(ran, plot)
    code = EXIT_CODES.get(ran.verdict.kind, 1)
    if not quiet:
        run_report(ran, file.method, {"--out": out, "--plot": plot}, Path(name).stem)
    elif code:
        _complain(str(ran.verdict), code)
    raise typer.Exit(code)


@app.command()
@_told()
def compare(name: SceneName, settings: Settings = None, force: Force = False) -> None:
    """Measure the closed-form twin against the kinetic run."""
    from .measure.compare import compare
    from .overview import saved_every
    from .progress import Watched
    from .report import comparison

    file = _read(name, settings, MethodKind.KINETIC)
    methods = [file.method, file.method.twin]  # type: ignore[union-attr]
    with Watched() as progress:
        measured = compare(file.scene, methods, file.clock, saved_every(file), force=force, progress=progress)
    comparison(measured)
    raise typer.Exit(max(EXIT_CODES.get(kind, 1) for kind in measured["verdict_kind"].to_numpy().tolist()))


@app.command()
@_told()
def check(name: Annotated[str, typer.Argument(metavar="FILE", help="A scene file, or a built-in scene.")]) -> None:
    """Validate a scene file, and print it with all that was filled in."""
    from .overview import filled_in, first_courant
    from .read import check, read_keys

    keys = read_keys(name)
    file = check(keys, name)
    filled_in(file, keys)
    if first_courant(file) > 1.0:
        raise InputError(f"{name}: clock: the first step breaks the CFL bound (28); take a smaller one, or force it")


def _read(name: str, settings: list[str] | None, method: MethodKind | None) -> SceneFile:
    from .read import change, check, read_keys, take_method

    keys = read_keys(name)
    if method:
        take_method(keys, method.value)
    change(keys, settings or [])
    return check(keys, name)


def _final_density(file: SceneFile) -> list[Dump]:
    """The density after the force of the first and the last step, where there is one on a grid."""
    from .kinetic.velocity import Fitted
    from .method import Kinetic
    from .watch.dump import Dump

    if isinstance(file.method, Kinetic) and not isinstance(file.method.velocity, Fitted):
        return [Dump(every=2**62)]
    return []
