"""Settings of the documentation, built by `make docs`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT), str(ROOT / "docs")]

import notebook_page  # noqa: E402

from fiberbend.version import __version__  # noqa: E402

project = "fiberbend"
author = "fiberbend developers"
copyright = "fiberbend developers, MIT licence"
release = version = __version__

extensions = [
    "math_pictures",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
]
exclude_patterns = ["_build"]
html_math_renderer = "pictures"
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_preserve_defaults = True

html_theme = "furo"
html_title = f"fiberbend {version}"
html_copy_source = False
html_show_sphinx = False


def setup(app: Any) -> None:
    """Run the notebook before its page is read."""
    app.connect("builder-inited", lambda _: notebook_page.write())
