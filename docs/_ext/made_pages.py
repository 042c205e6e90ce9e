"""Pages made from the code at the start of a build: the commands, and the keys of scene files. Git ignores them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer
from scene_keys import scene_page
from sphinx.application import Sphinx
from typer.cli import get_docs_for_click

from kinsim.cli import app as commands


def setup(app: Sphinx) -> dict[str, Any]:
    """Make them before anything is read."""
    app.connect("builder-inited", make)
    return {"parallel_read_safe": True}


def make(app: Sphinx) -> None:
    """Write each page, unless it is there already."""
    folder = Path(app.srcdir) / "reference" / "made"
    folder.mkdir(exist_ok=True)
    for name, text in (("commands.md", command_page()), ("scene-file.md", scene_page())):
        page = folder / name
        if not page.exists() or page.read_text(encoding="utf-8") != text:
            page.write_text(text, encoding="utf-8")


def command_page() -> str:
    """What ``kinsim --help`` and ``kinsim COMMAND --help`` say."""
    command = typer.main.get_command(commands)
    return get_docs_for_click(obj=command, ctx=typer.Context(command), name="kinsim", title="Commands")
