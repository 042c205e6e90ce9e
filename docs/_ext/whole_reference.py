"""A warning for every public name of kinsim that the reference leaves out; with `--fail-on-warning`, no site."""

from __future__ import annotations

from types import ModuleType
from typing import Any

from sphinx.application import Sphinx
from sphinx.util import logging

import kinsim

log = logging.getLogger(__name__)


def setup(app: Sphinx) -> dict[str, Any]:
    """Compare when all pages are read."""
    app.connect("env-check-consistency", compare)
    return {"parallel_read_safe": True}


def compare(app: Sphinx, env: Any) -> None:
    """Every name of `kinsim.__all__` and of `kinsim.exact.__all__` has its entry."""
    described = env.get_domain("py").objects
    for module in (kinsim, kinsim.exact):
        for name in module.__all__:
            full = f"{module.__name__}.{name}"
            if full not in described and not isinstance(getattr(module, name), ModuleType):
                log.warning("docs/reference: %s is public and not described; add it to a page there", full)
