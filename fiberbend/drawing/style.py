"""Format, size and letters of pictures."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, Literal

Format = Literal["png", "svg", "pdf"]

DPI = 100
"""Pixels per inch of the pictures of a run."""
_INCH = 25.4
_FONT = 13.0
_SHAPE = 0.7
"""Height over width of a picture whose height is not given."""
SAME_FILE = {
    # letters stay letters: text in a SVG, whole TrueType fonts in a PDF
    "pdf.fonttype": 42,
    "svg.fonttype": "none",
    # the same picture is the same file
    "svg.hashsalt": "fiberbend",
}
"""Settings of matplotlib while it writes a file."""
NO_DATE: dict[str, dict[str, Any]] = {
    "png": {},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None, "ModDate": None},
}
"""What a file of each format shall not have."""


@dataclasses.dataclass(frozen=True)
class Style:
    """Format, size and letters of a picture; the defaults are those of the pictures of a run.

    Attributes:
        format: of the file.
        width: of the picture, mm.
        height: of the picture, mm; by default 0.7 of its width.
        dpi: pixels per inch of a PNG, and of images within a SVG or a PDF.
        font_size: size of the names of axes, pt; other text and all lines are in proportion.

    Raises:
        ValueError: a size that is not above zero.
    """

    format: Format = "png"
    width: float = 254.0
    height: float | None = None
    dpi: float = float(DPI)
    font_size: float = _FONT

    def __post_init__(self) -> None:
        if self.format not in NO_DATE:
            raise ValueError(f"format {self.format!r}, expected {' or '.join(NO_DATE)}")
        for name in ("width", "height", "dpi", "font_size"):
            value = getattr(self, name)
            if value is not None and not 0 < value < math.inf:
                raise ValueError(f"{name} {value!r}, expected a number above zero")

    @property
    def inches(self) -> tuple[float, float]:
        """Width and height."""
        height = self.height if self.height is not None else _SHAPE * self.width
        return self.width / _INCH, height / _INCH

    @property
    def scale(self) -> float:
        """What sizes in points are multiplied with; 1 for the pictures of a run."""
        return self.font_size / _FONT

    def figure(self) -> Any:
        """An empty matplotlib figure of this size that needs no display."""
        return empty(self.inches, self.dpi)


DEFAULT = Style()
"""How the pictures of a run are drawn."""


def empty(inches: tuple[float, float], dpi: float) -> Any:
    """A matplotlib figure without anything on it that needs no display."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from fiberbend.notebook.figure import ShownFigure

    page = ShownFigure(figsize=inches, dpi=dpi)
    FigureCanvasAgg(page)
    return page
