"""The commands that take many runs. As in `cli`, each imports its own."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .shell import EXIT_CODES, Force, Quiet, SceneName, Settings, keep_apart, read_scene, resumable

Resume = Annotated[bool, typer.Option("--resume", help="Take what was finished before, and do the rest.")]


def sweep(
    name: SceneName,
    over: Annotated[
        list[str],
        typer.Option(
            metavar="KEY=VALUES", help="Vary a key: chute.zeta=0:0.5:11 (from, to, how many) or 0,0.1; may be repeated."
        ),
    ],
    settings: Settings = None,
    paired: Annotated[bool, typer.Option("--paired", help="Side by side, not every combination.")] = False,
    field: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Keep this history too: h, mass, ...; may be repeated.")
    ] = None,
    out: Annotated[Path, typer.Option(metavar="SWEEP.NC", help="Write here; a .csv has a row per member.")] = Path(
        "sweep.nc"
    ),
    resume: Resume = False,
    workers: Annotated[int, typer.Option(help="Processes to start; 0 runs all here.")] = 0,
    scheduler: Annotated[str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler that runs.")] = None,
    quiet: Quiet = False,
    force: Force = False,
) -> None:
    """Run a scene many times, with some of its values replaced.

    Finished members are kept beside the file, in SWEEP.NC.members; Ctrl-C costs only those under way. Exit code 1 if
    a member was stopped.
    """
    from .overview import saved_every
    from .progress import Watched
    from .report_many import study_faults, study_report
    from .studies.file import check_study_file, write_study
    from .studies.study import study
    from .studies.vary import read_over

    file = read_scene(name, settings, None)
    check_study_file(out, field or ())
    keep_apart(name, out)
    members = Path(f"{out}.members")
    with resumable(members), Watched(quiet) as progress:
        found = study(
            file.scene,
            file.method,
            file.clock,
            read_over(over),
            paired=paired,
            fields=field or (),
            save_every=saved_every(file),
            force=force,
            keep=members,
            resume=resume,
            workers=workers,
            scheduler=scheduler,
            tell=progress.tell,
        )
        write_study(found, out)
    if quiet:
        for line in study_faults(found):
            typer.echo(line, err=True)
    else:
        study_report(found, out)
    raise typer.Exit(max(EXIT_CODES.get(kind, 1) for kind in found["verdict_kind"].to_numpy().ravel().tolist()))


def trade(
    name: SceneName,
    settings: Settings = None,
    line: Annotated[
        list[str] | None,
        typer.Option(
            metavar="LINE",
            help="Only this part of the family: closed form, cell average, sampled, fitted, "
            "force, dx, courant, order; may be repeated.",
        ),
    ] = None,
    repeats: Annotated[int, typer.Option(help="So often each member is timed.")] = 5,
    out: Annotated[Path, typer.Option(metavar="TRADE.NC", help="Write here, and beside it .csv and .png.")] = Path(
        "trade.nc"
    ),
    resume: Resume = False,
    quiet: Quiet = False,
) -> None:
    """Measure cost against error of a family of methods on a scene.

    All members end when the scene's clock does, each with the steps of its own Courant number. What is measured is
    kept at once in TRADE.NC.members; after Ctrl-C, --resume does the rest.
    """
    from .errors import InputError
    from .plot import check_picture, plot_trade
    from .progress import Watched
    from .report_many import trade_report
    from .store import check_destination, write_netcdf, write_text
    from .trades.trade import trade

    file = read_scene(name, settings, None)
    check_destination(out)
    if out.suffix != ".nc":
        raise InputError(f"{out}: a table and a picture go beside it; name a file that ends in .nc")
    table, picture = out.with_suffix(".csv"), check_picture(out.with_suffix(".png"))
    keep_apart(name, out, table, picture)
    members = Path(f"{out}.members")
    with resumable(members), Watched(quiet) as progress:
        measured = trade(
            file.scene, file.method, file.clock, lines=line, repeats=repeats, keep=members, resume=resume,
            tell=progress.tell,
        )  # fmt: skip
        write_netcdf(measured, out)
        write_text(measured.to_dataframe().to_csv(index=False), table)
        plot_trade(measured, picture)
    if not quiet:
        trade_report(measured, [out, table, picture])


def budget(name: SceneName, settings: Settings = None) -> None:
    """Say where the error of a run comes from: velocity nodes, dx, dt, force."""
    from .progress import Watched
    from .report_many import budget_report
    from .trades.budget import budget

    file = read_scene(name, settings, None)
    with Watched() as progress:
        found = budget(file.scene, file.method, file.clock, tell=progress.tell)
    budget_report(found, file.scene.title or name)


def advise(name: SceneName, settings: Settings = None) -> None:
    """Say which parts of the model a scene needs, and what each costs, from a cheap coarse run."""
    from .progress import Watched
    from .report_many import advice_report
    from .trades.advise import advise

    file = read_scene(name, settings, None)
    with Watched() as progress:
        found = advise(file.scene, file.clock, tell=progress.tell)
    advice_report(found, file.scene.title or name)
