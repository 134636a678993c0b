"""What tests of plots look at."""

from __future__ import annotations

from typing import Any

import pytest

from fiberbend.drawing import curves, tip_path
from fiberbend.drawing.style import Style


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
