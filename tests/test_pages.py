"""What the pages beside the README say of the package is so."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from kinsim import __version__
from kinsim.cli import app

ROOT = Path(__file__).parents[1]
CHANGES, CITATION, CONTRIBUTING = (
    (ROOT / name).read_text(encoding="utf-8") for name in ("CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md")
)
GUIDES = ("contributing.md", "how-to/add-a-part.md")


def test_they_name_this_version():
    assert re.search(r"^version: (.*)$", CITATION, re.MULTILINE)[1] == __version__
    assert re.search(r"^## ([\d.]+)", CHANGES, re.MULTILINE)[1] == __version__


@pytest.mark.parametrize("page", [CHANGES, CONTRIBUTING])
def test_the_commands_they_name_exist(page):
    named = set(re.findall(r"`kinsim (\w+)", page))
    assert named
    assert named <= {command.callback.__name__ for command in app.registered_commands}


def test_the_files_that_the_guide_names_exist():
    pages = [CONTRIBUTING, *((ROOT / "docs" / page).read_text(encoding="utf-8") for page in GUIDES)]
    named = [name for page in pages for name in re.findall(r"`([\w.-]+(?:/[\w.-]+)+)`", page)]
    assert len(named) >= 12
    assert [name for name in named if not (ROOT / name).exists()] == []
