"""``python -m kinsim`` and the command ``kinsim``."""

import gc
import os
import sys

from .cli import app


def main() -> None:
    """Run the command line; where its output cannot be written it says so, and ends with exit code 1."""
    gc.set_threshold(50_000)  # at 700 new objects the collector wakes all through the imports, and finds nothing
    try:
        app(prog_name="kinsim")
    except OSError as error:
        print(f"kinsim: {error.filename or 'writing the output'}: {error.strerror or error}", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # or what is left for stdout would fail once more at the end
        sys.exit(1)


if __name__ == "__main__":
    main()
