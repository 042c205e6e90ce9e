"""Exact solutions to judge the schemes by; each is tested by its own residual.

Each is a frozen value, called with (x, t) to get h, u, with cell averages, and refuses what lies outside its domain.
`pull` is sin zeta, `resistance` is R = cos zeta tan delta and `beta` is epsilon k cos zeta of (1): `scene.pull`,
`scene.resistance` and `scene.beta` of a `kinsim.Scene`.
"""

from .accelerated import AcceleratedRiemann
from .cap import ParabolicCap
from .motion import Motion
from .pile import StaticPile
from .random_pile import coulomb_fill, random_pile
from .riemann import Riemann
from .shock import TravellingShock
from .slide import UniformSlide
from .stream import SteadyStream
from .transport import FreeTransport
from .wedge import SlidingWedge

__all__ = [
    "AcceleratedRiemann",
    "FreeTransport",
    "Motion",
    "ParabolicCap",
    "Riemann",
    "SlidingWedge",
    "StaticPile",
    "SteadyStream",
    "TravellingShock",
    "UniformSlide",
    "coulomb_fill",
    "random_pile",
]
