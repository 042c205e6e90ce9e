"""``python -m kinsim`` and the command ``kinsim``."""

from .cli import app


def main() -> None:
    """Run the command line."""
    app(prog_name="kinsim")


if __name__ == "__main__":
    main()
