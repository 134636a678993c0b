"""Formulas of the documentation as pictures within the page: no LaTeX, no script, no network."""

from __future__ import annotations

import html
from typing import Any

from docutils import nodes
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath

FONT = FontProperties(math_fontfamily="stix", family="STIXGeneral")
SIZE = 100.0
"""Of the font in the picture's own units: an em of the text beside it."""
LETTERS = {Outline.MOVETO: "M", Outline.LINETO: "L", Outline.CURVE3: "Q", Outline.CURVE4: "C"}


def picture(formula: str, scale: float = 1.0) -> str:
    """A formula as an SVG that takes size and colour of the text around it.

    Args:
        formula: LaTeX, as far as matplotlib's mathtext reads it.
        scale: size of its letters over that of the text around it.

    Raises:
        ValueError: what mathtext cannot read.
    """
    outline = TextPath((0, 0), f"${' '.join(formula.split())}$", size=SIZE, prop=FONT)
    box = outline.get_extents()
    left, right = min(box.x0, 0) - 2, box.x1 + 2
    low, high = min(box.y0, 0) - 2, max(box.y1, SIZE / 2) + 2
    em = scale / SIZE
    drawn = []
    for points, code in outline.iter_segments():
        if code == Outline.CLOSEPOLY:
            drawn.append("Z")
        else:
            numbers = " ".join(
                f"{value:.1f}" if axis % 2 == 0 else f"{-value:.1f}"
                for axis, value in enumerate(points)
            )
            drawn.append(f"{LETTERS[code]}{numbers}")
    return (
        f'<svg role="img" aria-label="{html.escape(formula, quote=True)}" '
        f'viewBox="{left:.1f} {-high:.1f} {right - left:.1f} {high - low:.1f}" '
        f'style="height:{(high - low) * em:.3f}em;vertical-align:{low * em:.3f}em;'
        f'max-width:100%;fill:currentColor"><path d="{"".join(drawn)}"/></svg>'
    )


def _inline(translator: Any, node: nodes.Element) -> None:
    translator.body.append(picture(node.astext()))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.Element) -> None:
    # mathtext has no display style: fractions in full size, and room beside the sign of an integral
    text = node.astext().replace(r"\frac", r"\dfrac").replace(r"int ", r"int\; ")
    lines = [picture(line, 1.15) for line in text.split(r"\\") if line.strip()]
    shown = "".join(f'<div style="margin:0.6em 0 0.6em 2em">{line}</div>' for line in lines)
    translator.body.append(f'<div class="formula">{shown}</div>')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, Any]:
    """Register the renderer `pictures`."""
    app.add_html_math_renderer("pictures", (_inline, None), (_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
