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
myst_enable_extensions = ["attrs_inline", "deflist", "dollarmath"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_preserve_defaults = True

html_theme = "furo"
html_title = f"fiberbend {version}"
html_copy_source = False
html_show_sphinx = False


def names_of_python() -> str:
    """Everything that `import fiberbend` offers, as directives of autodoc."""
    import inspect

    import fiberbend

    own = ("fiberbend.api", "fiberbend.drawing")
    offered = {name: getattr(fiberbend, name) for name in getattr(fiberbend, "__all__", ["run"])}
    functions, results, others = [], [], []
    for name, what in offered.items():
        if inspect.isfunction(what):
            functions += [f".. autofunction:: fiberbend.{name}", ""]
        elif inspect.isclass(what) and what.__module__.startswith(own):
            results += [f".. autoclass:: fiberbend.{name}", "   :members:", ""]
        elif inspect.isclass(what):
            # nobody makes these by calling them: a case comes from a file, an error from a check
            words = inspect.cleandoc(what.__doc__ or "").partition("\n")[0]
            others += [f".. py:class:: fiberbend.{name}", "   :no-index:", "", f"   {words}", ""]
    return "\n".join([*functions, *results, *others])


def setup(app: Any) -> None:
    """Write what is made from code before the pages are read."""

    def write(_: Any) -> None:
        notebook_page.write()
        (notebook_page.PAGE.parent / "python_names.txt").write_text(names_of_python(), "utf-8")

    app.connect("builder-inited", write)
