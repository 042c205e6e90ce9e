"""Pictures. The only folder that needs matplotlib, and only inside functions."""

from .density import plot_density
from .picture import check_picture
from .run import draw, plot_run, telling_rows
from .seams import plot_seams
from .trade import draw_trade, plot_trade

__all__ = [
    "check_picture", "draw", "draw_trade", "plot_density", "plot_run", "plot_seams", "plot_trade", "telling_rows",
]  # fmt: skip
