"""The command `kinsim lab`."""

from __future__ import annotations

from typing import Annotated

import typer

from ..shell import SceneName


def lab(
    name: SceneName = "silo",
    port: Annotated[int, typer.Option(help="Serve here; 0 takes a free port.")] = 0,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
) -> None:
    """Open a page on which the density moves: sliders, play and pause, and each step in its three stages.

    It is served to this machine only, until Ctrl-C. Needs the extra kinsim[lab].
    """
    from .serve import serve

    serve(name, port, browser, lambda address: typer.echo(f"kinsim lab: {address}   (Ctrl-C ends it)"))
    typer.echo("kinsim lab: ended")
