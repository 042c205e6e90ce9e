"""Run tests in the Chromium of this machine, those named or all of them; where there is none, say so."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome")


def main() -> int:
    """Run the tests in the browser; without one end with 0, in a sentence."""
    tests = sys.argv[1:] or [str(path) for path in sorted(Path("tests").glob("*_in_browser.py"))]
    found = os.environ.get("KINSIM_CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    if not found:
        print(f"no Chromium here: {', '.join(tests)} did not run (on Debian: apt-get install chromium)")
        return 0
    words = [sys.executable, "-m", "pytest", "--quiet", *tests]
    return subprocess.run(words, env={**os.environ, "KINSIM_CHROMIUM": found}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
