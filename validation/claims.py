"""How a validation script speaks: claims with a measured value and a bound, figures, tables.

A script has a docstring for its reader, a function ``main(chapter)``, and ends with ``run(main, __doc__)``. It exits
with 1 if a claim fails. ``--full`` asks for the paper's sizes and finer, ``--out FOLDER`` says where results go.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table


@dataclass(frozen=True)
class Claim:
    """One sentence with its number: `measured` has to lie in [low, high]."""

    sentence: str
    measured: float
    low: float
    high: float

    @property
    def holds(self) -> bool:
        """Whether it does; NaN never does."""
        return self.low <= self.measured <= self.high

    @property
    def bound(self) -> str:
        """The interval in words."""
        if self.low == self.high:
            return f"= {self.high:.6g}"
        if math.isinf(self.low):
            return f"<= {self.high:.3g}"
        if math.isinf(self.high):
            return f">= {self.low:.3g}"
        return f"{self.low:.4g} ... {self.high:.4g}"


@dataclass
class Chapter:
    """What one script has to say.

    Attributes:
        name: Name of the script.
        story: Its docstring.
        full: Whether the paper's sizes and finer are asked for.
        out: Where figures and the record go.
    """

    name: str
    story: str
    full: bool
    out: Path
    claims: list[Claim] = field(default_factory=list)
    figures: list[dict[str, str]] = field(default_factory=list)
    tables: list[dict[str, Any]] = field(default_factory=list)

    def claim(self, sentence: str, measured: float, *, low: float = -math.inf, high: float = math.inf) -> None:
        """`measured` lies in [low, high]."""
        if math.isinf(low) and math.isinf(high):
            raise ValueError(f"{sentence}: a claim without a bound cannot fail; give it one")
        if sentence.startswith("..."):
            raise ValueError(f"{sentence}: a sentence is read alone, too; write it out")
        self.claims.append(Claim(sentence, float(measured), float(low), float(high)))

    def figure(self, figure: Figure, name: str, caption: str) -> None:
        """Keep a figure as PNG under `name`."""
        self.out.mkdir(parents=True, exist_ok=True)
        file = f"{self.name}-{name}.png"
        figure.savefig(self.out / file, dpi=120)
        self.figures.append({"file": file, "caption": caption})

    def table(self, caption: str, heads: Sequence[str], rows: Sequence[Sequence[Any]]) -> None:
        """Keep a table; numbers are printed with three digits."""
        self.tables.append(
            {"caption": caption, "heads": list(heads), "rows": [[_shown(x) for x in row] for row in rows]}
        )

    def close(self, seconds: float) -> bool:
        """Print the claims, write the record, and say whether all hold."""
        self.out.mkdir(parents=True, exist_ok=True)
        record = {
            "name": self.name, "story": self.story, "full": self.full, "seconds": seconds,
            "figures": self.figures, "tables": self.tables,
            "claims": [asdict(claim) | {"holds": claim.holds, "bound": claim.bound} for claim in self.claims],
        }  # fmt: skip
        (self.out / f"{self.name}.json").write_text(json.dumps(record, indent=1), encoding="utf-8")
        console = Console()
        for kept in self.tables:
            console.print(_rich(kept["caption"], kept["heads"], kept["rows"]))
        rows = [[c.sentence, f"{c.measured:.4g}", c.bound, "holds" if c.holds else "FAILS"] for c in self.claims]
        console.print(_rich(f"{self.name}, {seconds:.1f} s", ["claim", "measured", "bound", ""], rows))
        return bool(self.claims) and all(claim.holds for claim in self.claims)


def run(main: Callable[[Chapter], None], story: str | None) -> None:
    """Run a script as a chapter and exit with 0 if all its claims hold."""
    name = Path(sys.argv[0]).stem
    parser = argparse.ArgumentParser(description=(story or name).split("\n")[0])
    parser.add_argument("--full", action="store_true", help="the paper's sizes and finer")
    parser.add_argument("--out", type=Path, default=Path("out/validation"), help="where results go")
    asked = parser.parse_args()
    chapter = Chapter(name, story or "", asked.full, asked.out)
    began = time.perf_counter()
    main(chapter)
    sys.exit(0 if chapter.close(time.perf_counter() - began) else 1)


def _shown(entry: Any) -> str:
    return f"{entry:.3g}" if isinstance(entry, float) else str(entry)


def _rich(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> Table:
    table = Table(*heads, title=title, title_justify="left")
    for row in rows:
        table.add_row(*row)
    return table
