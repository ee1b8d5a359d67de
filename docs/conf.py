"""How Sphinx builds the documentation: `python -m sphinx -W docs build/docs`, after `pip install '.[docs]'`."""

from __future__ import annotations

import os
import sys
from pathlib import Path

os.environ.setdefault("NUMBA_DISABLE_JIT", "1")  # kernels are read, not run: as functions they keep their signatures
sys.path.insert(0, str(Path(__file__).parent))  # reference.py
sys.path.insert(0, str(Path(__file__).parents[1] / "src"))

from limner import __version__

project = "limner"
author = "the authors of limner"
copyright = author
release = version = __version__

extensions = ["myst_parser", "reference"]
myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3
python_maximum_signature_line_length = 100
smartquotes = False  # a quotation mark or two hyphens of code in prose stay what they are
add_module_names = False  # the heading above names the module
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = "limner"
html_copy_source = False
