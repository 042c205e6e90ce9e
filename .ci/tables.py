"""Put tables and figures of a validation run into a page, between its markers.

Run it after ``kinsim validate --full``: ``python .ci/tables.py out/validation docs/schemes.md``; what is not in the
folder stays as it is on the page. A page asks for the
table number 2 of the script `scheme_4`, or for its claims, by

    <!-- table scheme_4 2 --> ... <!-- end -->        <!-- claims scheme_4 --> ... <!-- end -->

and for the figure ``scheme_4_pictures-cap.png`` by linking to ``figures/scheme_4_pictures-cap.png``.
"""

from __future__ import annotations

import json
import re
import shutil
import sys
from pathlib import Path
from typing import Any

MARKED = re.compile(r"(<!-- (table|claims) (\w+)(?: (\d+))? -->\n).*?(<!-- end -->)", re.DOTALL)
LINKED = re.compile(r"\(figures/([\w-]+\.png)\)")


def main() -> None:
    """Rewrite what is between the markers, and copy the figures."""
    folder, page = Path(sys.argv[1]), Path(sys.argv[2])

    def fill(found: re.Match[str]) -> str:
        kept = folder / f"{found[3]}.json"
        if not kept.exists():  # not run this time
            return found[0]
        record = json.loads(kept.read_text(encoding="utf-8"))
        made = table(record["tables"][int(found[4]) - 1]) if found[2] == "table" else claims(record)
        return found[1] + made + found[5]

    text = MARKED.sub(fill, page.read_text(encoding="utf-8"))
    page.write_text(text, encoding="utf-8")
    for name in LINKED.findall(text):
        if (folder / name).exists():
            shutil.copyfile(folder / name, page.parent / "figures" / name)


def table(kept: dict[str, Any]) -> str:
    """A table in Markdown, its caption above it."""
    return f"\n{kept['caption']}:\n\n{_rows(kept['heads'], kept['rows'])}\n"


def claims(record: dict[str, Any]) -> str:
    """The claims of a script, folded."""
    rows = [[c["sentence"], f"{c['measured']:.3g}", c["bound"] if c["holds"] else f"{c['bound']} **fails**"]
            for c in record["claims"]]  # fmt: skip
    made = _rows(["claim", "measured", "bound"], rows)
    return f"<details>\n<summary>Claims of {record['name']}.py</summary>\n\n{made}\n</details>\n"


def _rows(heads: list[str], rows: list[list[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)


if __name__ == "__main__":
    main()
