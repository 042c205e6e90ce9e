"""kinsim: a kinetic-level particle-density simulator for the Savage-Hutter equations.

Names load when they are first used (see ``__init__.pyi`` for the list).
"""

import lazy_loader as _lazy

_load, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    if name == "__version__":
        from importlib.metadata import version

        return version("kinsim")
    return _load(name)
