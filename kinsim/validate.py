"""Run the validation scripts of a checkout, and make one page of what they found."""

from __future__ import annotations

import base64
import json
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .errors import InputError

HELPERS = {"claims"}
"""Files in the folder that are no scripts."""

TEMPLATE = Path(__file__).parent / "report.html"


def find_scripts(only: Sequence[str] = (), folder: Path = Path("validation")) -> list[Path]:
    """The scripts in `folder`, or those of them called `only`.

    Raises:
        InputError: There is no such folder, or no script of that name.
    """
    if not (folder / "claims.py").is_file():
        raise InputError(f"no validation scripts in {folder}/; run this in a checkout of kinsim")
    scripts = {path.stem: path for path in sorted(folder.glob("*.py")) if path.stem not in HELPERS}
    for name in only:
        if name not in scripts:
            raise InputError(f"no validation script {name!r}; there are: {', '.join(scripts)}")
    return [path for name, path in scripts.items() if not only or name in only]


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
    records = []
    for number, script in enumerate(scripts):
        if told:
            told(script.stem, number / len(scripts))
        records.append(_run(script, out, full))
    (out / "index.html").write_text(page(records, out), encoding="utf-8")
    (out / "claims.md").write_text(claims_table(records), encoding="utf-8")
    return records


def holds(records: Sequence[dict[str, Any]]) -> bool:
    """Whether every script ended well and every claim holds."""
    return all(not record["error"] and all(claim["holds"] for claim in record["claims"]) for record in records)


def page(records: Sequence[dict[str, Any]], out: Path) -> str:
    """One self-contained page: a table of all claims, then script by script prose, figures, tables and claims."""
    try:
        from jinja2 import Environment
    except ImportError:
        raise InputError("the report needs jinja2; install it with: pip install 'kinsim[validate]'") from None
    from markdown_it import MarkdownIt

    from . import __version__

    shown = []
    for record in records:
        title, _, prose = record["story"].strip().partition("\n")
        pictures = [
            figure | {"data": base64.b64encode((out / figure["file"]).read_bytes()).decode()}
            for figure in record["figures"]
        ]
        shown.append(
            record
            | {"title": title, "prose": MarkdownIt("commonmark", {"html": False}).render(prose), "pictures": pictures}
        )
    template = Environment(autoescape=True).from_string(TEMPLATE.read_text(encoding="utf-8"))
    made = time.strftime("%Y-%m-%d")
    return template.render(records=shown, holds=holds(records), version=__version__, made=made)


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
