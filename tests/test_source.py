"""What code from outside consists of: all that compiled code freezes is told."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import kinsim
from kinsim.source import is_built_in, told

FILES = {
    "far": "LIMIT = 1.0\nTABLE = [1, 2]\n",
    "near": "import numba\nimport far\nfrom far import LIMIT\n\n@numba.njit\ndef helper(h):\n    return LIMIT * h\n\n"
    "def other(h):\n    return far.TABLE[0] + helper(h)\n",
    "mine": "from near import other\n\nclass Law:\n    def resistance(law, h, v, n):\n        return other(h)\n",
}

EDITS = [
    ("far", "1.0", "1.5"), ("far", "[1, 2]", "[3, 2]"), ("near", "LIMIT * h", "LIMIT + h"),
    ("mine", "other(h)", "-other(h)"),
]  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[Path]:
    for name, text in FILES.items():
        (tmp_path / f"{name}.py").write_text(text)
    sys.path.insert(0, str(tmp_path))
    yield tmp_path
    sys.path.remove(str(tmp_path))


def fresh() -> str:
    """The law as another process would see it."""
    for name in FILES:
        sys.modules.pop(name, None)
    importlib.invalidate_caches()
    text = told(importlib.import_module("mine").Law)
    for name in FILES:
        sys.modules.pop(name, None)
    return text


@pytest.mark.parametrize(("name", "old", "new"), EDITS)
def test_an_edit_far_away_is_seen(folder: Path, name: str, old: str, new: str) -> None:
    """Of a constant, a table, a compiled helper in another file; and nothing changes without one."""
    before = fresh()
    assert fresh() == before
    file = folder / f"{name}.py"
    file.write_text(file.read_text().replace(old, new, 1) + "\n\n")
    assert fresh() != before


def test_who_only_says_so_is_not_of_the_package() -> None:
    """A class that gives a module of the package as its own."""
    assert is_built_in(kinsim.Coulomb)
    assert is_built_in(kinsim.simulate)
    assert not is_built_in(type("Coulomb", (), {"__module__": "kinsim.model.friction"}))
    assert not is_built_in(Iterator)
