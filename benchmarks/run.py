"""`make bench`: everything on one thread, which has to be said before numpy is loaded."""

from __future__ import annotations

import os


def main() -> None:
    """Set the number of threads, then measure."""
    for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    import table

    table.main()


if __name__ == "__main__":
    main()
