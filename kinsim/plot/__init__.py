"""Pictures. The only folder that needs matplotlib, and only inside functions."""

from .density import plot_density
from .picture import check_picture
from .run import draw, plot_run, telling_rows
from .seams import plot_seams

__all__ = ["check_picture", "draw", "plot_density", "plot_run", "plot_seams", "telling_rows"]
