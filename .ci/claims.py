"""Put the claims of a validation run into the README, between its markers, or check that they are there.

Run it after ``kinsim validate``: ``python .ci/claims.py out/validation``; with ``--check`` it ends with 1 if the README
has other chapters, claims or bounds than the run. Measured values and margins may vary from machine to machine.
"""

from __future__ import annotations

import argparse
import difflib
import json
import re
import sys
from pathlib import Path

from kinsim.validate import chapters_table, claims_table, find_scripts

CHAPTERS = ("canary", "theorem_3", "figures", "mass_drift")
"""Those whose claims a reader wants first; the report has all of them."""

MARKED = re.compile(r"(<!-- claims -->\n).*?(<!-- end of claims -->)", re.DOTALL)

VARIES = {"measured", "worst margin"}
"""Columns that are not compared."""


def main() -> None:
    """Rewrite the tables, or compare them."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("folder", type=Path, help="where the run wrote its report")
    parser.add_argument("--check", action="store_true", help="change nothing; end with 1 if the README is another")
    asked = parser.parse_args()
    readme = Path("README.md")
    text, now = readme.read_text(encoding="utf-8"), tables(asked.folder)
    found = MARKED.search(text)
    if found is None:
        sys.exit("README.md: has no markers <!-- claims --> and <!-- end of claims -->")
    if not asked.check:
        readme.write_text(MARKED.sub(lambda found: found[1] + now + found[2], text), encoding="utf-8")
        return
    kept = found[0].split("\n", 1)[1].removesuffix("<!-- end of claims -->")
    unlike = list(difflib.unified_diff(fixed(kept), fixed(now), "README.md", "this run", lineterm="", n=0))
    if unlike:
        sys.exit("\n".join([*unlike, "the claims have changed; run python .ci/claims.py FOLDER"]))


def tables(folder: Path) -> str:
    """All chapters in a line each, and the claims of some."""
    records = {
        path.stem: json.loads((folder / f"{path.stem}.json").read_text(encoding="utf-8")) for path in find_scripts()
    }
    some = claims_table([records[name] for name in CHAPTERS])
    summary = f"<summary>The claims of {', '.join(CHAPTERS[:-1])} and {CHAPTERS[-1]}</summary>"
    return f"{chapters_table(list(records.values()))}\n<details>\n{summary}\n\n{some}\n</details>\n"


def fixed(text: str) -> list[str]:
    """The lines, without the columns that vary."""
    lines, left_out = [], set[int]()
    for line in text.splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)]
        if VARIES & set(cells):
            left_out = {number for number, cell in enumerate(cells) if cell in VARIES}
        lines.append(" | ".join(cell for number, cell in enumerate(cells) if number not in left_out or len(cells) < 3))
    return lines


if __name__ == "__main__":
    main()
