"""How the documentation site is built: `make docs`, or `sphinx-build docs out/docs`.

Nothing is fetched from elsewhere, neither while building nor while reading: formulas are set by a copy of MathJax, and
`.ci/offline.py` scans what was built.
"""

from __future__ import annotations

import os
import sys
from importlib.metadata import version as version_of
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))
os.environ["MATPLOTLIBRC"] = str(HERE / "matplotlibrc")  # how the pictures of tutorials look

project = "kinsim"
author = "the authors of kinsim"
version = release = version_of("kinsim")

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_design",
    "plain_docstrings",
    "made_pages",
    "whole_reference",
]
exclude_patterns = ["figures", "_ext"]
nitpicky = True
nitpick_ignore_regex = [
    ("py:class", r"(?!kinsim\.).*"),  # bases and types of other packages: their pages are elsewhere
]

myst_enable_extensions = ["amsmath", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

nb_execution_mode = "force"  # a stored output would outlive the code that made it
nb_execution_raise_on_error = True
nb_execution_in_temp = True
nb_execution_timeout = 120
nb_output_stderr = "error"
nb_merge_streams = True
nb_render_markdown_format = "myst"
nb_ipywidgets_js: dict[str, dict[str, str]] = {}  # would come from elsewhere

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # docstrings say what an argument is
autodoc_preserve_defaults = True
napoleon_numpy_docstring = False
napoleon_use_ivar = False
napoleon_attr_annotations = False

_mathjax = find_spec("sphinx-mathjax-offline")
if _mathjax is None or not _mathjax.submodule_search_locations:
    raise SystemExit("docs: the copy of MathJax is missing; install it: pip install 'kinsim[docs]'")
html_static_path = ["_static", f"{_mathjax.submodule_search_locations[0]}/static/mathjax/tex-svg.js"]
mathjax_path = "tex-svg.js"
mathjax3_config = {"tex": {"tags": "none"}, "options": {"enableMenu": False}}

html_theme = "furo"
html_title = f"kinsim {version}"
html_css_files = ["kinsim.css"]
html_show_copyright = False
html_copy_source = False
html_show_sourcelink = False
