"""Run what pages tell their readers to run: every block fenced as ``sh`` or ``python``, in a scratch folder.

Lines of ``sh`` that call make are left out: CI runs them itself. Relative paths into the checkout work, since the
scratch folder links to its folders.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

BLOCK = re.compile(r"^```(sh|python)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def main() -> None:
    """Run the blocks of the pages named on the command line; the first that fails ends it all."""
    root = Path.cwd()
    with tempfile.TemporaryDirectory() as scratch:
        for name in ("validation", "docs"):
            (Path(scratch) / name).symlink_to(root / name)
        for page in sys.argv[1:]:
            for number, (language, text) in enumerate(BLOCK.findall(Path(page).read_text(encoding="utf-8")), 1):
                print(f"{page}, block {number} ({language})", flush=True)
                if language == "python":
                    command = [sys.executable, "-c", text]
                else:
                    kept = [line for line in text.splitlines() if not line.startswith("make ")]
                    command = ["bash", "-euc", "\n".join(kept)]
                subprocess.run(command, cwd=scratch, check=True, stdout=subprocess.DEVNULL)


if __name__ == "__main__":
    main()
