"""'An effect that is not in the list does not exist', from YAML to kernels."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from bench import absent
from fem.kernels import cache_folder
from fem.kinematics.domain import Domain
from fem.scene import Scene
from fiberbend.case import convert
from fiberbend.effects.records import tip_strips
from fiberbend.models.choice import meshed
from fiberbend.models.parts import build
from fiberbend.reader.reader import as_case
from geometry.bodies.extrude import hexahedral_body
from geometry.mesh.data import MeshData
from machine.folders import CACHE, cache_root
from tests.run.conftest import small

DENSE = {
    "wall": "elastosil-m4601",
    "floor": {"name": "combined-base", "density": "1.2 g/cm^3"},
    "sheath": "ecoflex-0030",
}
EFFECTS: dict[str, dict[str, Any]] = {
    "pressure": {"to": "10 kPa"},
    "winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"},
    "gravity": {"direction": "-y"},
    "blocked-tip": {},
}
CLASSES = {
    "pressure": "ChamberPressure",
    "winding": "Winding",
    "gravity": "Gravity",
    "blocked-tip": "BlockedTip",
}


@pytest.fixture(scope="module")
def mesh() -> MeshData:
    """A coarse body that has every surface an effect may ask for."""
    case = as_case(small(effects=[{"pressure": {"to": "1 kPa"}}, {"blocked-tip": {}}]))
    return hexahedral_body(
        convert.dimensions(case.actuator),
        convert.mesh_size(case.mesh, True),
        tip_strips(case.effects),
    )


def scene(mesh: MeshData, names: list[str], leave_out: str = "") -> Scene:
    """The scene of a case with these effects, without one class of them."""
    materials = DENSE if "gravity" in names else small()["materials"]
    case = as_case(small(effects=[{n: EFFECTS[n]} for n in names], materials=materials, output={}))
    effects = build(case, mesh, meshed(case)).effects
    return Scene(Domain(mesh), [e for e in effects if type(e).__name__ != leave_out])


@pytest.mark.parametrize("absent", list(EFFECTS))
def test_absent_effect_leaves_no_trace(mesh: MeshData, absent: str) -> None:
    """No form, dof, kernel, constraint or discrete potential; with it something differs."""
    others = [name for name in EFFECTS if name != absent]
    without, by_hand = scene(mesh, others), scene(mesh, list(EFFECTS), CLASSES[absent])
    whole = scene(mesh, list(EFFECTS))

    def trace(s: Scene) -> tuple[Any, ...]:
        held = int((~s.free).sum())
        return s.signatures, s.kernels, s.body.size, held, sorted(s.discrete), s.supports

    assert [k for k, v in without.signatures.items() if by_hand.signatures.get(k) != v] == []
    assert trace(without) == trace(by_hand)
    assert trace(without) != trace(whole)


def test_order_of_the_case_does_not_matter(mesh: MeshData) -> None:
    """The scene sorts its effects: a permutation does not even recompile."""
    one, other = scene(mesh, list(EFFECTS)), scene(mesh, list(EFFECTS)[::-1])
    assert one.signatures == other.signatures
    assert one.keys == other.keys


@pytest.mark.long
def test_an_absent_effect_is_not_even_asked() -> None:
    """Calls from assembly to the last step are those of a program that never had the effects."""
    case, *settings = absent.CASES["section"]
    others = absent.absent_effects(case)
    assert {"GravityEffect", "ContactEffect", "BlockedTipEffect"} <= {*others}
    with_them = absent.counted(case, [*absent.QUIET, *settings])
    assert with_them == absent.counted(case, [*absent.QUIET, *settings], others)
    # it does count: an effect in the scene, which a program without it does not read
    thread = "{winding: {pattern: double-helix, pitch: 3 mm, fiber: kevlar, as: smeared}}"
    listed = f"{{pressure: {{to: 5 kPa}}}}, {thread}"
    output = [*absent.QUIET, "mesh.section=1", "output.at_angles=[]"]
    free, straight = (
        absent.counted(case, [*output, f"effects=[{listed}{more}]"])
        for more in ("", ", {straight: {}}")
    )
    assert free["unknowns"] == straight["unknowns"]
    assert free["calls"] != straight["calls"]
    with pytest.raises(subprocess.CalledProcessError):
        absent.counted(case, [*output, f"effects=[{listed}, {{straight: {{}}}}]"], others)


@pytest.mark.long
def test_what_others_compile_is_not_counted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tests side by side share a folder of kernels: what is counted is one program's."""
    folder = cache_folder()
    copy = tmp_path / cache_root().path.name / folder.name
    shutil.copytree(folder, copy)
    monkeypatch.setenv(CACHE, str(tmp_path))
    case, *settings = absent.CASES["section"]
    before = absent.counted(case, [*absent.QUIET, *settings])
    for number in range(30):
        (copy / f"of_another_program_{number}.txt").touch()
    assert absent.counted(case, [*absent.QUIET, *settings]) == before
