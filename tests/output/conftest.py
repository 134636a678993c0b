"""What tests of plots look at."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from fiberbend.drawing import curves, tip_path
from fiberbend.drawing.renderer import Renderer
from fiberbend.drawing.style import Style


@pytest.fixture(scope="module")
def renderer() -> Iterator[Renderer]:
    """A window in which all tests of a module draw."""
    with Renderer() as window:
        yield window


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The axes of every plot that is saved."""
    axes: list[Any] = []
    save = curves.save

    def kept(page: Any, target: Any, style: Style) -> None:
        axes.append(page.axes[0])
        save(page, target, style)

    monkeypatch.setattr(curves, "save", kept)
    monkeypatch.setattr(tip_path, "save", kept)
    return axes
