"""Figures that a notebook shows, though pyplot does not know them."""

from __future__ import annotations

import io

from matplotlib.figure import Figure

_CSS = 96.0
"""Pixels of a page in an inch."""
_LARGER = 1.5
"""A figure of one column of a journal is hard to read at its size on a screen."""


class ShownFigure(Figure):
    """A matplotlib figure, with a picture of itself for IPython."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        """The picture, and the size at which it is shown."""
        content = io.BytesIO()
        self.savefig(content, format="png", facecolor="white")
        width, height = (round(_LARGER * _CSS * inches) for inches in self.get_size_inches())
        return content.getvalue(), {"width": width, "height": height}
