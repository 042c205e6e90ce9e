"""Put the claims of a validation run into the README, between its markers.

Run it after ``kinsim validate``: ``python .ci/claims.py out/validation``.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

from kinsim.validate import claims_table

CHAPTERS = ("canary", "figures", "theorem_3", "mass_drift")
"""Those that a reader wants first; the report has all of them."""

MARKED = re.compile(r"(<!-- claims -->\n).*?(<!-- end of claims -->)", re.DOTALL)


def main() -> None:
    """Rewrite the table."""
    folder, readme = Path(sys.argv[1]), Path("README.md")
    records = [json.loads((folder / f"{name}.json").read_text(encoding="utf-8")) for name in CHAPTERS]
    table = claims_table(records)
    text = readme.read_text(encoding="utf-8")
    readme.write_text(MARKED.sub(lambda found: found[1] + table + found[2], text), encoding="utf-8")


if __name__ == "__main__":
    main()
