"""Run the validation scripts of a checkout, and make one page of what they found."""

from __future__ import annotations

import base64
import json
import math
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from .errors import InputError

HELPERS = {"claims"}
"""Files in the folder that are no scripts."""

ORDER = ("canary", "theorem", "errata", "figures", "rest", "mass", "zigzag", "", "scheme", "convergence")
"""Beginnings of names in the order of the page: from theorems to figures to convergence; "" stands for all others."""

TEMPLATE = Path(__file__).parent / "report.html"


def find_scripts(only: Sequence[str] = (), folder: Path = Path("validation")) -> list[Path]:
    """The scripts in `folder`, or those of them called `only`, in the order of the page.

    Raises:
        InputError: There is no such folder, or no script of that name.
    """
    if not (folder / "claims.py").is_file():
        raise InputError(f"no validation scripts in {folder}/; run this in a checkout of kinsim")
    paths = sorted(folder.glob("*.py"), key=lambda path: (_place(path.stem), path.stem))
    scripts = {path.stem: path for path in paths if path.stem not in HELPERS}
    for name in only:
        if name not in scripts:
            raise InputError(f"no validation script {name!r}; there are: {', '.join(scripts)}")
    return [path for name, path in scripts.items() if not only or name in only]


def _place(name: str) -> int:
    known = [number for number, beginning in enumerate(ORDER) if beginning and name.startswith(beginning)]
    return known[0] if known else ORDER.index("")


def validate(
    scripts: Sequence[Path], out: Path, full: bool = False, told: Callable[[str, float], None] | None = None
) -> list[dict[str, Any]]:
    """Run `scripts`, each in a process of its own, and write ``index.html`` and ``claims.md`` into `out`.

    Args:
        scripts: Which.
        out: Folder for the page, made if it is missing.
        full: Ask for the paper's sizes and finer.
        told: Called with the name of the script that runs now and the share that is done.

    Returns:
        One record per script: name, story, seconds, figures, tables, claims (sentence, measured, bound, holds), error
        (a line, empty if it ended well) and what it then printed as `trace`.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{out}: no folder can be made there ({error.strerror}); name another") from None
    records: list[dict[str, Any]] = []
    try:
        for number, script in enumerate(scripts):
            if told:
                told(script.stem, number / len(scripts))
            records.append(_run(script, out, full))
    except KeyboardInterrupt:
        done = f"{len(records)} of {len(scripts)} scripts are done, what they found is in {out}"
        raise KeyboardInterrupt(f"{done}; --only NAME runs each of the others") from None
    (out / "index.html").write_text(page(records, out), encoding="utf-8")
    (out / "claims.md").write_text(chapters_table(records) + "\n" + claims_table(records), encoding="utf-8")
    return records


def holds(records: Sequence[dict[str, Any]]) -> bool:
    """Whether every script ended well and every claim holds."""
    return all(not record["error"] and all(claim["holds"] for claim in record["claims"]) for record in records)


def page(records: Sequence[dict[str, Any]], out: Path) -> str:
    """One self-contained page: a row per chapter, what fails, then script by script prose, claims, figures, tables."""
    try:
        from jinja2 import Environment
    except ImportError:
        raise InputError("the report needs jinja2; install it with: pip install 'kinsim[validate]'") from None
    from markdown_it import MarkdownIt

    from . import __version__

    shown = []
    for record in records:
        title, prose = _story(record)
        failing = [claim for claim in record["claims"] if not claim["holds"]]
        pictures = [
            figure | {"data": base64.b64encode((out / figure["file"]).read_bytes()).decode()}
            for figure in record["figures"]
        ]
        shown.append(record | {
            "title": title, "prose": MarkdownIt("commonmark", {"html": False}).render(prose), "pictures": pictures,
            "failing": failing, "holding": [claim for claim in record["claims"] if claim["holds"]],
            "margin": worst_margin(record),
        })  # fmt: skip
    template = Environment(autoescape=True).from_string(TEMPLATE.read_text(encoding="utf-8"))
    made = time.strftime("%Y-%m-%d")
    return template.render(records=shown, holds=holds(records), version=__version__, made=made)


def _story(record: Mapping[str, Any]) -> tuple[str, str]:
    title, _, prose = record["story"].strip().partition("\n")
    return title, prose


def margin(claim: Mapping[str, Any]) -> float:
    """How far a claim is from failing: 1 at best, 0 at its bound, below 0 if it fails.

    Between two bounds it is the distance to the nearer one over half of theirs; above or below one, the distance over
    the larger of the two sizes. A claim of exactly one number has no margin to speak of: 1 if it holds.
    """
    low, high, measured = claim["low"], claim["high"], claim["measured"]
    if not math.isfinite(measured):
        return 1.0 if claim["holds"] else -math.inf
    if math.isfinite(low) and math.isfinite(high) and low < high:
        return float(min(measured - low, high - measured) / (0.5 * (high - low)))
    bound, inside = (high, high - measured) if math.isfinite(high) else (low, measured - low)
    size = max(abs(bound), abs(measured))
    return float(inside / size) if inside and low < high else 1.0 if claim["holds"] else -1.0


def worst_margin(record: Mapping[str, Any]) -> float:
    """The least margin of a chapter's claims, 1 if it makes none."""
    return min((margin(claim) for claim in record["claims"]), default=1.0)


def chapters_table(records: Sequence[Mapping[str, Any]]) -> str:
    """The chapters as a Markdown table: title, number of claims, how many fail, worst margin, script."""
    lines = ["| chapter | claims | failing | worst margin | script |", "|---|---|---|---|---|"]
    for record in records:
        failing = sum(not claim["holds"] for claim in record["claims"])
        broke = " **broke**" if record.get("error") else ""
        cells = (_cell(_story(record)[0]), len(record["claims"]), f"{failing}{broke}", f"{worst_margin(record):.1%}")
        lines.append(f"| {' | '.join(map(str, cells))} | `{record['name']}` |")
    return "\n".join(lines) + "\n"


def claims_table(records: Sequence[dict[str, Any]]) -> str:
    """The claims as a Markdown table: sentence, measured value, bound, script."""
    lines = ["| claim | measured | bound | script |", "|---|---|---|---|"]
    for record in records:
        for claim in record["claims"]:
            mark = "" if claim["holds"] else " **fails**"
            measured = f"{claim['measured']:.3g}{mark}"
            lines.append(f"| {_cell(claim['sentence'])} | {measured} | {claim['bound']} | `{record['name']}` |")
        if record.get("error"):
            lines.append(f"| **broke**: {_cell(record['error'])} | | | `{record['name']}` |")
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _run(script: Path, out: Path, full: bool) -> dict[str, Any]:
    kept = out / f"{script.stem}.json"
    kept.unlink(missing_ok=True)
    command = [sys.executable, str(script), "--out", str(out), *(["--full"] if full else [])]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    error = f"ended with exit code {done.returncode}"
    if kept.exists():
        record: dict[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
        if done.returncode == int(not (record["claims"] and all(claim["holds"] for claim in record["claims"]))):
            error = "" if record["claims"] else "makes no claim"
    else:
        record = {"name": script.stem, "story": script.stem, "full": full, "seconds": 0.0}
        record |= {"figures": [], "tables": [], "claims": []}
        if done.returncode > 0:  # below 0 a signal ended it, and it had no time for a word of its own
            error = last_error(done.stderr) or error
    return record | {"error": error, "trace": done.stderr.strip() if error else ""}


def last_error(told: str) -> str:
    """The first line of the exception that ends a traceback, which may go on for more lines; else the last line."""
    lines = told.rstrip().split("\n")
    frames = [number for number, line in enumerate(lines) if line.startswith('  File "')]
    after = lines[frames[-1] + 1 :] if frames else []
    return next((line for line in after if line[:1].strip()), lines[-1])
