"""The command line. Only what ``--help`` needs is imported here; each command imports its own."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .commands import advise, budget, sweep, trade
from .errors import InputError
from .film.command import animate
from .lab.command import lab
from .shell import (
    EXIT_CODES,
    SCENE,
    Force,
    MethodKind,
    Quiet,
    SceneName,
    Settings,
    complain,
    keep_apart,
    read_scene,
    told,
)
from .stability.command import atlas

if TYPE_CHECKING:
    from .diagnostics.dump import Dump
    from .method import Kinetic, Macroscopic
    from .progress import Watched
    from .read import SceneFile
    from .run import Run
    from .trades.choose import Chosen

app = typer.Typer(
    help="Run the Savage-Hutter equations with a particle density f(x, xi), or with its closed-form twin.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


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
@told()
def scenes() -> None:
    """List the built-in scenes and their figures in the paper."""
    from .overview import scene_list
    from .read import built_in, read_keys

    scene_list({name: read_keys(path) for name, path in built_in().items()})


@app.command()
@told()
def rooms() -> None:
    """List every family and its variants, each with a line and the equation it implements."""
    from .overview import room_list

    room_list()


@app.command()
@told()
def run(
    name: Annotated[str | None, SCENE] = None,
    method: Annotated[MethodKind | None, typer.Option(help="Take this wing instead of the one in the file.")] = None,
    settings: Settings = None,
    out: Annotated[Path | None, typer.Option(metavar="RUN.NC", help="Write the run to this netCDF file.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="RUN.PNG", help="Draw it: .png, .pdf or .svg.")] = None,
    dump: Annotated[
        list[str] | None,
        typer.Option(
            metavar="KEY=VALUE,...",
            help="Keep f: name=f, stage=equilibrium|transport|force, every=1000, x=-1:1, xi=-1:1; may be repeated.",
        ),
    ] = None,
    density: Annotated[
        Path | None, typer.Option(metavar="F.PNG", help="Draw the first --dump over (x, xi), and cuts beside M.")
    ] = None,
    cut: Annotated[list[float] | None, typer.Option(metavar="X", help="Where --density cuts; may be repeated.")] = None,
    causes: Annotated[
        bool, typer.Option("--causes", help="Book what each stage did to mass, momentum, energy and entropy.")
    ] = False,
    checkpoint: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Put the run down here now and then, and on Ctrl-C.")
    ] = None,
    every: Annotated[float, typer.Option(metavar="SECONDS", help="From one checkpoint to the next.")] = 60.0,
    resume: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Go on with a run that was put down, bit for bit.")
    ] = None,
    accuracy: Annotated[
        float | None,
        typer.Option(metavar="EPS", help="Pick the cheapest velocity nodes: L1(h) to the closed form below EPS mass."),
    ] = None,
    quiet: Quiet = False,
    force: Force = False,
) -> None:
    """Run a scene, and say how it ended.

    Exit code: 0 if it went to its end, 1 if it was stopped, 2 if the input is bad, 130 if it was interrupted. A
    checkpoint is removed when the run went to its end and is written to --out.
    """
    from .progress import Watched
    from .read import read_dumps
    from .simulate import simulate
    from .store import check_destination

    if resume and (name or method or settings or dump or causes or force or checkpoint or accuracy is not None):
        raise InputError(f"--resume goes on with what {resume} says; beside it give --out, --plot and --density alone")
    if not (name or resume):
        raise InputError("run: name a scene (kinsim scenes lists them), or a checkpoint with --resume")
    if out:
        check_destination(out)
    for picture in (plot, density):
        if picture:
            from .plot import check_picture, plot_density, plot_run

            check_picture(picture)
    keep_apart(name, out, plot, density, checkpoint, resume)
    if resume:
        from .resume import read_request
        from .resume import resume as go_on

        request = read_request(resume)
        asked, dumps = request["method"], request["dumps"]
    else:
        from .checkpoint import Checkpoint

        file = read_scene(str(name), settings, method)
        asked, dumps = file.method, read_dumps(dump or [])
    if density and not dumps:
        raise InputError("--density draws a dump; ask for one, for example --dump every=1000")
    chosen = None
    with Watched(quiet) as progress:
        if resume:
            ran = go_on(resume, progress=progress)
        else:
            chosen = _picked(file, accuracy, bool(dumps or causes), progress)
            asked = chosen.method if chosen else file.method
            ran = simulate(
                file.scene,
                asked,
                file.clock,
                **file.kept,
                force=force,
                dumps=[*dumps, *(_final_density(asked, dumps) if out or plot or checkpoint else [])],
                causes=causes,
                checkpoint=Checkpoint(str(checkpoint), every) if checkpoint else None,
                progress=progress,
            )
    if out:
        ran.to_netcdf(out)
    if plot:
        plot_run(ran, plot)
    if density:
        plot_density(ran, density, dumps[0].name, cut or ())
    code = EXIT_CODES.get(ran.verdict.kind, 1)
    kept = checkpoint or resume
    if kept and ran.verdict.kind == "interrupted" and kept.exists():
        files = "".join(f" {option} {file}" for option, file in (("--out", out), ("--plot", plot)) if file)
        typer.echo(f"put down; go on with: kinsim run --resume {kept}{files}", err=True)
    elif kept and out and code == 0:
        kept.unlink(missing_ok=True)
    measured = _measured(chosen, ran)
    if not quiet:
        from .report import causes_report, run_report
        from .report_many import accuracy_rows

        rows = accuracy_rows(chosen, measured)
        run_report(ran, asked, {"--out": out, "--plot": plot}, Path(name or "run").stem, rows)
        causes_report(ran)
    elif code:
        complain(str(ran.verdict), code)
    raise typer.Exit(code)


@app.command()
@told()
def compare(
    name: SceneName,
    settings: Settings = None,
    seams: Annotated[bool, typer.Option("--seams", help="Compare stage by stage, from each saved state.")] = False,
    plot: Annotated[Path | None, typer.Option(metavar="SEAMS.PNG", help="Draw the seams: .png, .pdf or .svg.")] = None,
    force: Force = False,
) -> None:
    """Measure the closed-form twin against the kinetic run."""
    from .measure.compare import compare
    from .overview import saved_every
    from .plot import check_picture, plot_seams
    from .progress import Watched
    from .report import comparison, seam_report

    if plot:
        check_picture(plot)
        seams = True
    file = read_scene(name, settings, MethodKind.KINETIC)
    methods = [file.method, file.method.twin]  # type: ignore[union-attr]
    with Watched() as progress:
        measured = compare(
            file.scene, methods, file.clock, saved_every(file), force=force, seams=seams, progress=progress
        )
    comparison(measured)
    if seams:
        seam_report(measured)
    if plot:
        plot_seams(measured, plot)
    raise typer.Exit(max(EXIT_CODES.get(kind, 1) for kind in measured["verdict_kind"].to_numpy().tolist()))


@app.command()
@told()
def crosscheck(
    flux: Annotated[str, typer.Argument(metavar="MODULE:NAME", help="A flux(hl, ul, hr, ur, beta) -> (F1, F2).")],
    beta: Annotated[float, typer.Option(help="As in equation (1).")] = 0.4,
    count: Annotated[int, typer.Option(help="Random states per regime.")] = 400,
    tolerance: Annotated[float, typer.Option(help="Largest error allowed, in flux scales.")] = 1e-12,
    seed: Annotated[int, typer.Option(help="Of the random states.")] = 0,
) -> None:
    """Judge a flux of your own, regime by regime: quadrature, grid, consistency, mirror symmetry.

    The module is imported from the current folder or the Python path, and so its code runs. Exit code 1 if it fails.
    """
    from .measure.crosscheck import crosscheck
    from .report import crosscheck_report
    from .userflux import load_flux

    found = crosscheck(load_flux(flux), beta=beta, count=count, tolerance=tolerance, seed=seed)
    crosscheck_report(found, flux)
    raise typer.Exit(0 if found.passes else 1)


@app.command()
@told()
def validate(
    full: Annotated[bool, typer.Option("--full", help="The paper's sizes and finer; takes long.")] = False,
    only: Annotated[list[str] | None, typer.Option(metavar="NAME", help="This script only; may be repeated.")] = None,
    out: Annotated[Path, typer.Option(metavar="FOLDER", help="Where the report goes.")] = Path("out/validation"),
) -> None:
    """Run the validation scripts of this checkout, and write one page of what they found.

    Exit code 1 if a claim fails.
    """
    from .progress import Watched
    from .report import validation_report
    from .validate import find_scripts, holds, validate

    scripts = find_scripts(only or ())
    with Watched() as progress:
        records = validate(scripts, out, full, told=progress.tell)
    validation_report(records, out)
    raise typer.Exit(0 if holds(records) else 1)


@app.command()
@told()
def check(name: Annotated[str, typer.Argument(metavar="FILE", help="A scene file, or a built-in scene.")]) -> None:
    """Validate a scene file, and print it with all that was filled in."""
    from .clock import first_courant
    from .overview import filled_in
    from .read import check, read_keys

    keys = read_keys(name)
    file = check(keys, name)
    filled_in(file, keys)
    if first_courant(file.scene, file.clock) > 1.0:
        raise InputError(f"{name}: clock: the first step breaks the CFL bound (28); take a smaller one, or force it")


@app.command()
@told()
def schema(
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="Write it here.")] = None,
) -> None:
    """Print the JSON schema of scene files, with which editors complete their keys."""
    import json

    from .schema import scene_schema
    from .store import write_text

    text = json.dumps(scene_schema(), indent=1, ensure_ascii=False)
    if out is None:
        typer.echo(text)
        return
    write_text(f"{text}\n", out)


for command in (sweep, trade, budget, advise, atlas, animate, lab):
    app.command()(told()(command))


def _measured(chosen: Chosen | None, ran: Run) -> float:
    """The velocity error that a picked method came to; one that is above what was asked for is told as a fault."""
    if chosen is None:
        return 0.0
    from .trades.choose import velocity_error

    measured = velocity_error(ran)
    if chosen.accuracy < measured < math.inf:
        told = f"the velocity error came to {measured:.2g}, above the {chosen.accuracy:.2g} asked for"
        typer.echo(f"{told}; ask for less, or take more nodes", err=True)
    return measured


def _picked(file: SceneFile, accuracy: float | None, grid: bool, progress: Watched) -> Chosen | None:
    """The velocity nodes for an accuracy, if one is asked for; on a grid where f is looked at."""
    if accuracy is None:
        return None
    from .trades.choose import choose

    return choose(file.scene, file.method, file.clock, accuracy=accuracy, grid=grid, tell=progress.tell)


def _final_density(method: Kinetic | Macroscopic, dumps: list[Dump]) -> list[Dump]:
    """The density after the force of the first and the last step, where there is one on a grid."""
    from .diagnostics.dump import Dump
    from .kinetic.velocity import Fitted
    from .method import Kinetic

    if isinstance(method, Kinetic) and not isinstance(method.velocity, Fitted):
        taken = any(dump.name == "f" for dump in dumps)
        return [Dump(name="f_end" if taken else "f", every=2**62)]
    return []
