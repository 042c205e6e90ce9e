"""Compiled code on disk: found again, never stale, and out of the way."""

from __future__ import annotations

import ast
import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import kinsim
from kinsim.kernel import stamped

PACKAGE = Path(kinsim.__file__).parent

SMALL = """
import sys
{before}
import numpy as np
import kinsim
from kinsim.macroscopic.half_moments import half_moments_closed, small_side
half_moments_closed(0.5, 0.1, 0.4)
print(repr(half_moments_closed(0.5, 0.1, 0.4)[1]))
print(sum(half_moments_closed.stats.cache_misses.values()), sum(half_moments_closed.stats.cache_hits.values()))
"""

WHOLE = """
import gc, sys
import kinsim
from numba.core.dispatcher import Dispatcher
from kinsim import Blocks, Cells, ConstantSlope, Coulomb, Fixed, Kinetic, Macroscopic, Scene, Uniform, simulate
scene = Scene(Cells(0, 1, 8), Blocks((0.5,), (1, 0.5)), ConstantSlope(0.1), Coulomb(0.2), epsilon=0.4)
for scheme in (1, 2, 3):
    simulate(scene, Macroscopic(scheme), Fixed(1e-3, 3))
    for equilibrium in ("cell-average", "sampled"):
        simulate(scene, Kinetic(scheme, Uniform(8), equilibrium), Fixed(1e-3, 3))
kernels = [thing for thing in gc.get_objects() if isinstance(thing, Dispatcher)]
kernels = [kernel for kernel in kernels if kernel.py_func.__module__.startswith("kinsim")]
print(sum(sum(k.stats.cache_misses.values()) for k in kernels), sum(sum(k.stats.cache_hits.values()) for k in kernels))
"""


def python(code: str, cache: Path | None, path: Path | None = None, stream: str = "stdout", **more: str) -> str:
    """Run `code` in a process of its own, and return what it prints."""
    env = {**os.environ, **more}
    env.pop("KINSIM_CACHE_DIR", None)
    if cache is not None:
        env["KINSIM_CACHE_DIR"] = str(cache)
    if path is not None:
        env["PYTHONPATH"] = str(path)
    done = subprocess.run([sys.executable, "-P", "-c", code], env=env, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return str(getattr(done, stream))


def test_second_process_compiles_nothing(tmp_path: Path) -> None:
    """All kernels of a run with both wings and all schemes are found again."""
    misses, _ = map(int, python(WHOLE, tmp_path).split())
    assert misses > 10
    misses, hits = map(int, python(WHOLE, tmp_path).split())
    assert misses == 0
    assert hits > 10
    files = sorted(tmp_path.rglob("*"))
    python(WHOLE, tmp_path)
    assert sorted(tmp_path.rglob("*")) == files  # and the cache does not grow


def test_compiling_is_told_in_a_line_and_only_where_there_is_something_to_compile(tmp_path: Path) -> None:
    """On the error stream, and not in --quiet."""
    code = "from kinsim.progress import Watched\n"
    code += "from kinsim.balance.impulse import acceleration\n"
    code += "with Watched({quiet}): acceleration(1.0, 0.1, 0.2)\n"
    told = "compiling kernels, only this once"
    for cache, quiet, said in (("one", False, [told]), ("one", False, []), ("two", True, [])):
        assert python(code.format(quiet=quiet), tmp_path / cache, stream="stderr").splitlines() == said


def copied(where: Path) -> Path:
    """The package once more, in a folder of its own."""
    shutil.copytree(PACKAGE, where / "kinsim", ignore=shutil.ignore_patterns("__pycache__"))
    return where


def test_an_edited_helper_in_another_file_changes_the_numbers(tmp_path: Path) -> None:
    """numba stamps the kernel's own file only; ours stamps all, and what is compiled anew replaces the old."""
    source = copied(tmp_path / "src")
    caller = source / "kinsim" / "balance" / "borrower.py"
    caller.write_text(
        "from ..kernel import kernel\n"
        "from ..macroscopic.half_moments import small_side\n\n\n"
        "@kernel\ndef borrowed(h: float) -> float:\n    return small_side(h, 0.0, 0.4)[0]\n"
    )
    code = """
import kinsim.balance.borrower as b
print(b.__file__, b.borrowed(0.5), sum(b.borrowed.stats.cache_hits.values()))
"""
    first = python(code, tmp_path / "cache", source).split()
    again = python(code, tmp_path / "cache", source).split()
    assert first[0] == str(caller)
    assert (first[1], first[2], again[1], again[2]) == (first[1], "0", first[1], "1")
    helper = source / "kinsim" / "macroscopic" / "half_moments.py"
    text = helper.read_text()
    edited = text.replace("return max(m1, 0.0), max(m2, 0.0)", "return 2.0 * max(m1, 0.0), max(m2, 0.0)")
    assert edited != text
    helper.write_text(edited)
    assert float(python(code, tmp_path / "cache", source).split()[1]) == 2 * float(first[1])
    helper.write_text(text)
    assert python(code, tmp_path / "cache", source).split()[1] == first[1]


def test_all_numbers_that_kernels_freeze_are_stamped() -> None:
    """What a file with kernels imports in capitals stands in a file whose edits make the compiler start anew."""
    known, frozen = set(stamped()), 0
    for path in known:
        if b"@kernel" not in path.read_bytes():
            continue
        for taken in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(taken, ast.ImportFrom) and any(name.name.isupper() for name in taken.names):
                home = PACKAGE.joinpath(*path.relative_to(PACKAGE).parts[: -taken.level], *taken.module.split("."))
                if home.parent == PACKAGE.parent or not taken.level:
                    continue
                frozen += 1
                assert home.with_suffix(".py") in known, f"{path}: {ast.unparse(taken)}"
    assert frozen >= 3


def test_two_copies_of_the_package_do_not_share_code(tmp_path: Path) -> None:
    """Same cache folder, one of them edited: each keeps its own numbers."""
    one, other = copied(tmp_path / "one"), copied(tmp_path / "other")
    helper = other / "kinsim" / "balance" / "sides.py"
    helper.write_text(helper.read_text().replace("0.5 * total2)", "0.25 * total2)").replace(
        "total2 = h * u * u", "total2 = 2.0 * h * u * u"))  # fmt: skip
    code = SMALL.format(before="")
    printed = [python(code, tmp_path / "cache", path).split() for path in (one, other, one, other)]
    numbers = [number for number, _, _ in printed]
    assert numbers[0] == numbers[2] != numbers[1] == numbers[3]
    assert [misses for _, misses, _ in printed] == ["1", "1", "0", "0"]


def test_a_package_folder_that_cannot_be_written_is_no_obstacle(tmp_path: Path) -> None:
    """Nothing is written beside the sources."""
    source = copied(tmp_path / "src")
    folders = [source / "kinsim", *(p for p in (source / "kinsim").rglob("*") if p.is_dir())]
    before = sorted((source / "kinsim").rglob("*"))
    for folder in folders:
        folder.chmod(stat.S_IRUSR | stat.S_IXUSR)
    try:
        for _ in range(2):
            printed = python(SMALL.format(before="sys.dont_write_bytecode = True"), tmp_path / "cache", source).split()
    finally:
        for folder in folders:
            folder.chmod(stat.S_IRWXU)
    assert printed[1:] == ["0", "1"]
    assert sorted((source / "kinsim").rglob("*")) == before


def test_a_cache_folder_that_cannot_be_made_is_no_obstacle(tmp_path: Path) -> None:
    """A file stands in its place: code is kept elsewhere, for this process."""
    blocked = tmp_path / "blocked"
    blocked.write_text("")
    assert python(SMALL.format(before=""), blocked).split()[1] == "1"


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
