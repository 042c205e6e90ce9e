"""The command `kinsim animate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..shell import EXIT_CODES, Force, MethodKind, Quiet, Settings, complain, keep_apart, read_scene


def animate(
    name: Annotated[
        str,
        typer.Argument(metavar="SCENE|RUN.NC", help="A built-in scene, a scene file, or a run of kinsim run --out."),
    ],
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FILM", help="Where the film goes: .gif, .html, or .mp4 by ffmpeg.")
    ],
    method: Annotated[MethodKind | None, typer.Option(help="Take this wing instead of the one in the file.")] = None,
    settings: Settings = None,
    frames: Annotated[int, typer.Option(help="At most so many, evenly spread over time.")] = 100,
    rate: Annotated[int, typer.Option(help="Frames per second.")] = 20,
    width: Annotated[int, typer.Option(help="In pixels.")] = 900,
    quiet: Quiet = False,
    force: Force = False,
) -> None:
    """Make a film: the density over (x, xi) beside height and velocity, and their closed-form twin.

    A stored run shows f where --dump kept it along with the saved states, otherwise M of its h and u. A macroscopic
    run shows h and u. Exit code 1 if the run was stopped; the film then ends there.
    """
    from ..errors import InputError
    from ..progress import Watched
    from .animate import check_shape, is_stored, project
    from .reel import reel_of
    from .shoot import shoot
    from .stored import read_reel
    from .writers import check_film

    check_film(out)
    check_shape(frames, rate, width)
    keep_apart(name, out)
    if is_stored(name) and (method or settings or force):
        raise InputError(f"{name}: has been run; --method, --set and --force belong to a scene")
    verdict = None
    with Watched(quiet) as progress:
        if is_stored(name):
            reel = read_reel(name, frames)
        else:
            runs = shoot(read_scene(name, settings, method), frames, force, lambda share: progress(0.5 * share))
            verdict = runs[0].verdict
            reel = reel_of(runs[0], frames, runs[1] if len(runs) > 1 else None)
        begun = 0.0 if verdict is None else 0.5
        project(reel, out, rate, width, lambda share: progress.tell("drawing", begun + (1.0 - begun) * share))
    if not quiet:
        what = "h and u" if not reel.kinetic else "M of h and u" if reel.density is None else "f"
        typer.echo(f"{out}: {reel.t.size} frames of {what}, t = {reel.t[0]:.4g} to {reel.t[-1]:.4g}")
    if verdict is not None and verdict.kind not in EXIT_CODES:
        complain(str(verdict), 1)
