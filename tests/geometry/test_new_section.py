"""A new section shape is one class and one line in the table."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path
from typing import ClassVar

import pytest

import geometry
from geometry.actuator import Profile, Side
from geometry.bodies.extrude import hexahedral_body
from geometry.checks import check
from geometry.sections.blocks import Layout
from geometry.sections.rectangle import RectangleActuator
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize, Strips
from geometry.sections.table import SECTIONS, inconsistencies, make_actuator
from geometry.winding.helix import Winding

GIVEN = {
    "section": "square",
    "side": 9.0,
    "length": 40.0,
    "wall": 2.0,
    "floor": 3.0,
    "sheath": None,
    "cap": 8.0,
}


@dataclasses.dataclass(frozen=True, kw_only=True)
class SquareActuator(ShapedActuator):
    """A square chamber in walls as a rectangle's."""

    section: ClassVar[str] = "square"

    side: float
    floor: float

    def _rectangle(self) -> RectangleActuator:
        given = dataclasses.asdict(self)
        side = given.pop("side")
        return RectangleActuator(width=side, height=side, **given)

    def closed_forms(self) -> Profile:
        """Those of the rectangle."""
        return self._rectangle().closed_forms()

    def outline(self) -> tuple[Side, ...]:
        """Those of the rectangle."""
        return self._rectangle().outline()

    def layout(self, size: MeshSize, strips: Strips | None) -> Layout:
        """That of the rectangle."""
        return self._rectangle().layout(size, strips)


def test_a_new_shape_needs_its_class_and_its_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SECTIONS, SquareActuator.section, SquareActuator)
    square = make_actuator(GIVEN)
    assert square.region_areas() == pytest.approx({"wall": 2 * 2 * 9 + 13 * 2, "floor": 13 * 3})
    mesh = hexahedral_body(square, MeshSize(axial=4), Strips(2.0, 3.0))
    report = check(mesh, square, Winding("double-helix", 3, 0.38))
    assert all(abs(row["error"]) < 1e-9 for row in report.values() if "error" in row)


def test_a_new_shape_tells_what_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(SECTIONS, SquareActuator.section, SquareActuator)
    assert not list(inconsistencies(GIVEN))
    assert dict(inconsistencies(GIVEN | {"side": None, "radius": 8.0, "layer": 0.5})) == {
        "side": "missing, expected the side of a square, above zero",
        "radius": "no effect on a square, expected no value",
        "layer": "no effect on a square, expected no value",
    }


@pytest.mark.parametrize("name", SECTIONS)
def test_no_other_module_knows_a_shape_by_name(name: str) -> None:
    root = Path(str(geometry.__file__)).parent
    found = [
        str(path.relative_to(root))
        for path in root.rglob("*.py")
        if re.search(rf"[\"']{name}[\"']", path.read_text(encoding="utf-8"))
    ]
    assert found == [f"sections/{name}.py"]
