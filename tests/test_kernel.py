"""Compiled code on disk: found again, never stale, and out of the way."""

from __future__ import annotations

import ast
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kinsim
from kinsim import Blocks, Cells, ConstantSlope, Coulomb, Fixed, Frictionless, Macroscopic, Scene, simulate
from kinsim.compiled import stamped
from kinsim.progress import COMPILING, KEPT, STEP

PACKAGE = Path(kinsim.__file__).parent

SMALL = """
from kinsim import Blocks, Cells, ConstantSlope, Coulomb, Fixed, Macroscopic, Scene, simulate
from kinsim.progress import Watched
scene = Scene(Cells(0, 1, 20), Blocks((0.5,), (1, 0.5)), ConstantSlope(0.4), Coulomb(0.2), epsilon=0.4)
with Watched({quiet}):
    print(simulate(scene, Macroscopic(1), Fixed(1e-3, 20)).h[-1].tobytes().hex())
"""
"""A run that tells when it compiles, and prints its last heights."""

TOLD = COMPILING.format(what=STEP) + KEPT

SCENE = Scene(Cells(0, 1, 20), Blocks((0.5,), (1, 0.5)), ConstantSlope(0.4), Coulomb(0.2), epsilon=0.4)

STAMP = "from kinsim.compiled import source_stamp\nprint(source_stamp())"


def started(code: str, cache: Path | None, path: Path | None = None, **more: str) -> subprocess.Popen[str]:
    """Begin to run `code` in a process of its own."""
    env = {**os.environ, **more}
    env.pop("KINSIM_CACHE_DIR", None)
    if cache is not None:
        env["KINSIM_CACHE_DIR"] = str(cache)
    if path is not None:
        env["PYTHONPATH"] = str(path)
    asked = [sys.executable, "-P", "-c", code]
    return subprocess.Popen(asked, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def ended(process: subprocess.Popen[str]) -> tuple[str, list[str]]:
    """What it printed, and the lines on its error stream."""
    out, err = process.communicate(timeout=600)
    assert process.returncode == 0, err
    return out, err.splitlines()


def python(code: str, cache: Path | None, path: Path | None = None, **more: str) -> str:
    """Run `code` in a process of its own, and return what it prints."""
    return ended(started(code, cache, path, **more))[0]


def heights(printed: str) -> np.ndarray:
    """The numbers of `SMALL`."""
    return np.frombuffer(bytes.fromhex(printed.split()[-1]))


@pytest.fixture(scope="module")
def expected() -> np.ndarray:
    """Heights of the small run in this process."""
    return simulate(SCENE, Macroscopic(1), Fixed(1e-3, 20)).h[-1]


@pytest.fixture(scope="module")
def filled(tmp_path_factory: pytest.TempPathFactory, expected: np.ndarray) -> Path:
    """A cache that two processes have filled at once; both came to the right numbers."""
    folder = tmp_path_factory.mktemp("filled")
    processes = [started(SMALL.format(quiet=False), folder) for _ in range(2)]
    for process in processes:
        out, err = ended(process)
        np.testing.assert_array_equal(heights(out), expected)
        assert err == [TOLD]
    assert not [path for path in code_in(folder) if path.suffix != ".code"]
    return folder


@pytest.fixture
def cache(filled: Path, tmp_path: Path) -> Path:
    """The same, to break things in."""
    return Path(shutil.copytree(filled, tmp_path / "cache"))


def code_in(cache: Path) -> list[Path]:
    """The files of a cache."""
    return sorted(path for path in cache.rglob("*") if path.is_file())


def copied(where: Path) -> Path:
    """The package once more, in a folder of its own."""
    shutil.copytree(PACKAGE, where / "kinsim", ignore=shutil.ignore_patterns("__pycache__"))
    return where


def test_a_second_process_compiles_nothing(cache: Path, expected: np.ndarray) -> None:
    """Nor does it write anything."""
    files = code_in(cache)
    assert len(files) >= 5  # the loop, and the parts that scheme 1 has
    out, err = ended(started(SMALL.format(quiet=False), cache))
    np.testing.assert_array_equal(heights(out), expected)
    assert err == []
    assert code_in(cache) == files


def test_an_edit_of_a_kernel_source_changes_the_stamp_and_no_other_does(tmp_path: Path) -> None:
    """Of a file with formulas, of one of numbers that they freeze; not of the command line."""
    source = copied(tmp_path / "src")
    first = python(STAMP, None, source)
    assert first == python(STAMP, None)
    for name in (
        "schemes/formulas.py",
        "schemes/tile.py",
        "macroscopic/closed_form.py",
        "compiled/kernel.py",
        "solver/march.py",
    ):
        file = source / "kinsim" / name
        text = file.read_text(encoding="utf-8")
        file.write_text(text + "\n", encoding="utf-8")
        assert python(STAMP, None, source) != first, name
        file.write_text(text, encoding="utf-8")
    for name in ("cli.py", "report.py"):
        file = source / "kinsim" / name
        file.write_text(file.read_text(encoding="utf-8") + "\n", encoding="utf-8")
    assert python(STAMP, None, source) == first


def test_a_copy_of_the_package_takes_its_code_and_nothing_is_written_beside_sources(
    cache: Path, tmp_path: Path
) -> None:
    source = copied(tmp_path / "src")
    before = sorted(source.rglob("*"))
    out, err = ended(started(SMALL.format(quiet=False), cache, source, PYTHONDONTWRITEBYTECODE="1"))
    assert heights(out).size == 20
    assert err == []
    assert sorted(source.rglob("*")) == before


def frozen_by(tree: ast.Module) -> set[str]:
    """Names in the compiled functions of a file: those with a mark, and the methods of the classes that are asked."""
    marks = {"kernel", "formula", "routine", "generic", "question", "short_question"}
    names: set[str] = set()
    for thing in tree.body:
        decorators = {part.id for d in getattr(thing, "decorator_list", []) for part in ast.walk(d)
                      if isinstance(part, ast.Name)}  # fmt: skip
        asked = isinstance(thing, ast.ClassDef) and any(ast.unparse(base) == "NamedTuple" for base in thing.bases)
        if asked or marks & decorators:
            names |= {part.id for part in ast.walk(thing) if isinstance(part, ast.Name)}
    return names


def test_all_numbers_that_kernels_freeze_are_stamped() -> None:
    """What compiled functions take from another file in capitals stands in one whose edits make it anew."""
    known, frozen = set(stamped()), 0
    for path in known:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        used = {name for name in frozen_by(tree) if name.isupper()}
        for taken in ast.walk(tree):
            if not (isinstance(taken, ast.ImportFrom) and taken.level and taken.module):
                continue
            if not used & {name.name for name in taken.names}:
                continue
            home = PACKAGE.joinpath(*path.relative_to(PACKAGE).parts[: -taken.level], *taken.module.split("."))
            frozen += 1
            file = home / "__init__.py" if home.is_dir() else home.with_suffix(".py")
            assert file in known, f"{path}: {ast.unparse(taken)}"
    assert frozen >= 3


@pytest.mark.parametrize("damage", ["empty", "truncated", "changed"])
def test_a_damaged_file_costs_a_compilation(cache: Path, expected: np.ndarray, damage: str) -> None:
    """And is mended by it."""
    file = next(path for path in code_in(cache) if path.name.startswith("looked"))
    whole = file.read_bytes()
    changed = whole[:-9] + bytes([whole[-9] ^ 255]) + whole[-8:]
    file.write_bytes({"empty": b"", "truncated": whole[: len(whole) // 2], "changed": changed}[damage])
    for said in ([TOLD], []):
        out, err = ended(started(SMALL.format(quiet=False), cache))
        np.testing.assert_array_equal(heights(out), expected)
        assert err == said


def test_a_cache_folder_that_cannot_be_made_is_no_obstacle(tmp_path: Path) -> None:
    """A file stands in its place: code is then kept in memory, as in the next test."""
    blocked = tmp_path / "blocked"
    blocked.write_text("")
    assert python("from kinsim.compiled import cache_folder\nprint(cache_folder())", blocked).strip() == "None"
    assert blocked.read_text() == ""


NOBODY = """
import os, pwd
def unknown(*given): raise KeyError("who are you?")
pwd.getpwuid = pwd.getpwnam = unknown
"""


def test_a_user_without_a_home_and_a_name_is_no_obstacle(expected: np.ndarray) -> None:
    """An empty environment, and a number of a user that no list knows, as in a container."""
    code = NOBODY + SMALL.format(quiet=False)
    done = subprocess.run([sys.executable, "-P", "-c", code], env={}, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(heights(done.stdout), expected)
    assert done.stderr.splitlines() == [COMPILING.format(what=STEP)]


def test_without_compiling_the_numbers_are_the_same(tmp_path: Path, expected: np.ndarray) -> None:
    """NUMBA_DISABLE_JIT: what a debugger steps through; products and sums are then rounded apart."""
    out, err = ended(started(SMALL.format(quiet=False), tmp_path / "cache", NUMBA_DISABLE_JIT="1"))
    np.testing.assert_allclose(heights(out), expected, rtol=1e-13)
    assert err == []
    assert code_in(tmp_path) == []


LAW = """
from typing import NamedTuple

class Mine(NamedTuple):
    mu: float

    def resistance(law, h, v, n):
        return {formula}
"""

OWN = SMALL.replace("scene = ", "{law}\nscene = ").replace("Coulomb(0.2)", "Mine(0.2)")


def with_friction(friction: object) -> np.ndarray:
    """Heights of the small run with another law."""
    return simulate(replace(SCENE, friction=friction), Macroscopic(1), Fixed(1e-3, 20)).h[-1]


def test_an_edited_law_of_ones_own_gives_the_new_numbers(cache: Path, tmp_path: Path) -> None:
    """And back; a law that is as it was is found again."""
    file = tmp_path / "mine.py"
    code = OWN.format(law="from mine import Mine", quiet=False)
    rough, smooth = with_friction(Coulomb(np.arctan(0.2))), with_friction(Frictionless())
    assert np.abs(rough - smooth).max() > 1e-6
    for formula, heights_then, said in (
        ("law.mu * n", rough, [TOLD]), ("0.0 * law.mu * n", smooth, [TOLD]), ("law.mu * n", rough, []),
    ):  # fmt: skip
        file.write_text(LAW.format(formula=formula))
        out, err = ended(started(code, cache, tmp_path))
        np.testing.assert_allclose(heights(out), heights_then, rtol=1e-12)
        assert err == said


def test_a_law_of_a_script_leaves_nothing_behind(cache: Path) -> None:
    """Nobody could find it again; and it is compiled in each run, right."""
    code = OWN.format(law=LAW.format(formula="law.mu * n"), quiet=True)
    first = python(code, cache)
    files = code_in(cache)
    assert python(code, cache) == first
    assert code_in(cache) == files
    np.testing.assert_allclose(heights(first), with_friction(Coulomb(np.arctan(0.2))), rtol=1e-12)


def test_import_loads_nothing_heavy() -> None:
    """Neither numba nor matplotlib nor scipy nor xarray until they are needed."""
    heavy = {"numba", "matplotlib", "scipy", "xarray", "h5netcdf", "pandas", "typer", "rich", "pydantic"}
    loaded = python("import sys, kinsim\nprint(*{name.split('.')[0] for name in sys.modules})", None).split()
    assert "kinsim" in loaded
    assert heavy.isdisjoint(loaded)


def test_scenes_are_made_without_numba() -> None:
    """A scene is a value; only running it compiles."""
    code = "import sys, kinsim\nkinsim.Scene(kinsim.Cells(0, 1, 4), kinsim.Parabola())\nprint(*sys.modules)"
    assert {"numba", "matplotlib", "xarray"}.isdisjoint(python(code, None).split())
