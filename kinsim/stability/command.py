"""The command `kinsim atlas`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..shell import Quiet, Settings


def atlas(
    settings: Settings = None,
    axis: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Along this axis only; may be repeated.")
    ] = None,
    plane: Annotated[
        list[str] | None, typer.Option(metavar="NAME,NAME", help="Two axes against each other; may be repeated.")
    ] = None,
    steps: Annotated[int, typer.Option(min=10, help="About so many at each point.")] = 200,
    out: Annotated[Path | None, typer.Option(metavar="ATLAS.NC", help="Write all measures to this file.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="ATLAS.PNG", help="Draw the map: .png, .pdf or .svg.")] = None,
    keep: Annotated[Path | None, typer.Option(metavar="FOLDER", help="Keep finished points here.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Take finished points from --keep.")] = False,
    workers: Annotated[int, typer.Option(help="Processes to start; 0 runs all here.")] = 0,
    quiet: Quiet = False,
) -> None:
    """Take a method to the extremes: Courant number, heights, velocities, slopes, friction, cells, nodes.

    The method is scheme 4 in closed form; --set method.kind=kinetic, --set method.scheme=1 and so on change it.
    """
    from ..errors import InputError
    from ..plot import check_picture
    from ..progress import Watched
    from ..read import read_method
    from ..report_many import atlas_report
    from ..shell import keep_apart, resumable
    from ..store import check_destination, write_netcdf
    from .atlas import atlas
    from .axes import USUAL

    planes = [tuple(one.split(",")) for one in plane or ()]
    if any(len(one) != 2 for one in planes):
        raise InputError("--plane: give two axes, for example --plane courant,zeta")
    if resume and keep is None:
        raise InputError("--resume takes finished points from a folder; name it with --keep")
    method = read_method(settings or [])
    if out:
        check_destination(out)
    if plot:
        check_picture(plot)
    keep_apart(out, plot)
    asked = [*(axis or (() if planes else USUAL)), *((one, two) for one, two in planes)]
    with resumable(keep), Watched(quiet) as progress:
        found = atlas(method, asked, steps=steps, keep=keep, resume=resume, workers=workers, tell=progress.tell)
    if out:
        write_netcdf(found, out)
    if plot:
        from ..plot.atlas import plot_atlas

        plot_atlas(found, plot)
    if not quiet:
        atlas_report(found, out, plot)
