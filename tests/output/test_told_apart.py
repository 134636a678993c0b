"""What pictures tell apart: families of threads, strips of fabric, what acts at the tip."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from fiberbend.case.case import Case
from fiberbend.drawing.page import COLORS
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.reader.reader import as_case
from fiberbend.results.mesh_file import mesh_of
from fiberbend.results.scenery import scenery
from fiberbend.results.space import Space
from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.snapshot import ModelMesh
from geometry.mesh.data import Floats

BRAID = [
    {"angle_from_axis": "30 deg", "hand": "left", "starts": 4},
    {"angle_from_axis": "30 deg", "hand": "right", "starts": 4},
]


def _case(*more: dict[str, Any], model: str = "cell", families: Any = BRAID) -> Case:
    winding = {"fiber": "kevlar", "as": "discrete", "families": families}
    if not families:
        winding = {"pattern": "double-helix", "pitch": "6 mm", "fiber": "kevlar", "as": "smeared"}
    return as_case(
        {
            "title": "A braid",
            "actuator": {
                "section": "circle",
                "radius": "5 mm",
                "length": "40 mm",
                "wall": "1.5 mm",
                "cap": "4 mm",
            },
            "materials": {"wall": "dragon-skin-30"},
            "effects": [{"pressure": {"to": "10 kPa"}}, {"winding": winding}, *more],
            "model": model,
            "mesh": {"section": 1, "axial": "2 mm"},
        }
    )


def _mesh(case: Case) -> ModelMesh:
    from fiberbend.models.choice import choose_model

    elements = choose_model(case)[0].elements()
    assert elements is not None
    return mesh_of(case, elements)


def _slopes(model_mesh: ModelMesh) -> Floats:
    """By family, the turn about the axis over the rise of every segment, rad/mm: sign is hand."""
    lines = model_mesh.lines
    assert lines is not None
    found: list[set[int]] = [set() for _ in model_mesh.families]
    for number in range(len(found)):
        own = lines.family == number
        data = fiber_lines(
            model_mesh.mesh,
            type(lines)(**{name: values[own] for name, values in vars(lines).items()}),
        )
        assert set(data.cell_data["family"]) == {number}
        points, flat, at = np.asarray(data.points), np.asarray(data.lines), 0
        while at < len(flat):
            x, y, z = points[flat[at + 1 : at + 1 + flat[at]]].T
            turn = np.diff(np.unwrap(np.arctan2(y - y_middle(model_mesh), x)))
            found[number] |= set(np.sign(turn * np.diff(z)).astype(int))
            at += flat[at] + 1
    return np.array([sorted(each) for each in found], dtype=float)


def y_middle(model_mesh: ModelMesh) -> float:
    """Of the outline, mm."""
    y = model_mesh.mesh.nodes[:, 1]
    return float(y.min() + y.max()) / 2


@pytest.mark.parametrize("model", ["cell", "body"])
def test_every_line_has_the_family_of_its_hand_also_as_an_image(model: str) -> None:
    case = _case(model=model)
    own = _mesh(case)
    assert own.mesh.half
    assert [look.name for look in own.families] == ["30° left", "30° right"]
    assert [look.image for look in own.families] == [1, 0]
    whole = Space(case, own, both=True).model_mesh
    assert _slopes(whole).tolist() == [[-1.0], [1.0]]


def test_families_have_a_colour_each_and_patterns_the_colour_of_fibers() -> None:
    surfaces = BodySurfaces(Space(_case(), _mesh(_case())).model_mesh)
    assert surfaces.names == ["wall", "30° left", "30° right"]
    assert len(set(surfaces.family_colors.values())) == 2
    assert {tube.color for tube in surfaces.fiber_tubes()} == {*surfaces.family_colors.values()}


def test_helices_of_a_pattern_are_fibers_alike_each_with_its_own_number() -> None:
    case = _case(families=None)
    winding = {"pattern": "double-helix", "pitch": "6 mm", "fiber": "kevlar", "as": "discrete"}
    case = as_case(case, {"effects.1.winding": winding})
    surfaces = BodySurfaces(Space(case, _mesh(case)).model_mesh)
    assert surfaces.names == ["wall", "fiber"]
    assert {tube.color for tube in surfaces.fiber_tubes()} == {COLORS["fiber"]}
    assert _slopes(Space(case, _mesh(case), both=True).model_mesh).tolist() == [[1.0], [-1.0]]


def test_fabric_is_as_wide_as_its_strip_and_where_it_lies() -> None:
    strip = {"at": {"angle": "90 deg"}, "width": "6 mm", "thickness": "0.2 mm", "modulus": "1 GPa"}
    case = _case({"strip": strip}, model="section", families=None)
    surfaces = BodySurfaces(Space(case, _mesh(case)).model_mesh, scenery(case))
    (patch,) = surfaces.fabric()
    x, y, z = np.asarray(patch.data.points).T
    assert np.ptp(z) == pytest.approx(40)
    reach = 3 / 6.5
    assert np.arctan2(y - 6.5, x).max() == pytest.approx(reach, rel=1e-2)
    assert np.arctan2(y - 6.5, x).min() == pytest.approx(-reach, rel=1e-2)
    assert patch.data.area == pytest.approx(40 * 6, rel=0.03)


@pytest.mark.parametrize("width", [0.3, 2.0, 30.0])
@pytest.mark.parametrize("at", ["90 deg", "5 deg", "200 deg"])
def test_fabric_in_motion_has_its_area_however_narrow(width: float, at: str) -> None:
    """Coarser pieces than a strip is wide do not swallow or widen it."""
    place = {"width": f"{width} mm", "thickness": "0.2 mm", "modulus": "1 GPa"}
    strip = {"strip": {"at": {"angle": at}, **place}}
    case = _case(strip, model="section", families=None)
    space = Space(case, _mesh(case), both=True)
    surfaces = BodySurfaces(space.model_mesh, scenery(case))
    nodes = surfaces.mesh.nodes
    triangles, (rest, longer) = surfaces.fabric_in([nodes, nodes * [1.0, 1.0, 1.25]])
    assert len(rest) == len(longer)
    for points, stretch in ((rest, 1.0), (longer, 1.25)):
        a, b, c = points[triangles].swapaxes(0, 1)
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
        # a little off the surface
        assert area == pytest.approx(40 * width * stretch * 6.6 / 6.5, rel=0.01)


def test_fabric_of_zones_ends_at_their_borders() -> None:
    strip = {"width": "3 mm", "thickness": "0.2 mm", "modulus": "1 GPa"}
    data = _case(model="body", families=None).resolved()
    zones = [{"length": "10 mm", "strip": {"at": "bottom", **strip}}]
    zones += [{"length": "30 mm", "strip": {"at": "top", **strip}}]
    case = as_case(data | {"zones": zones})
    assert [window.ends for window in scenery(case).strips] == [(0.0, 10.0), (10.0, 40.0)]
    lower, upper = BodySurfaces(_mesh(case), scenery(case)).fabric()
    below, above = (np.asarray(patch.data.points) for patch in (lower, upper))
    assert (below[:, 2].min(), below[:, 2].max()) == pytest.approx((0.0, 10.0))
    assert (above[:, 2].min(), above[:, 2].max()) == pytest.approx((10.0, 40.0))
    assert below[:, 1].max() < 0.5
    assert above[:, 1].min() > 12.5


def test_as_much_of_a_tip_load_as_is_on_is_shown() -> None:
    case = _case({"tip-load": {"force": ["0 N", "-0.4 N", "0.2 N"]}}, model="body")
    at_tip = scenery(case, [{"step": 3, "load_tip_load": 0.5}]).at_tip
    assert at_tip == {3: {"tip load": pytest.approx((0.0, -0.2, 0.1))}}
    assert scenery(case, [{"step": 3, "load_tip_load": 1.0}]).greatest() == pytest.approx(
        math.hypot(0.4, 0.2)
    )
