"""kinsim: a kinetic-level particle-density simulator for the Savage-Hutter equations.

Names load when they are first used (see ``__init__.pyi`` for the list).
"""

from importlib.metadata import version as _version

import lazy_loader as _lazy

__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
__version__ = _version("kinsim")
