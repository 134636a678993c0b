"""The scene for SOFA, built with a recorder in SOFA's place: nothing here runs SOFA."""

from __future__ import annotations

import contextlib
import importlib.util
import sys
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend.export import mjcf
from fiberbend.export.ends import KEYS
from tests.export import rods

FIELDS = {
    "BeamHookeLawForceFieldRigid": {
        *("crossSectionShape", "radius", "length", "useInertiaParams"),
        *("GI", "GA", "EA", "EIy", "EIz", "rayleighStiffness"),
    },
    "DiscreteCosseratMapping": {
        *("curv_abs_input", "curv_abs_output", "input1", "input2", "output", "debug", "radius"),
    },
}
"""Of the plugin's components, by its source."""


class Data:
    """A field that a controller writes, or reads as a value."""

    def __init__(self, value: Any) -> None:
        self.value = value

    @contextlib.contextmanager
    def writeable(self) -> Iterator[Any]:
        """The array, which is kept."""
        array = np.array(self.value, dtype=float)
        yield array
        self.value = array.tolist()


class Thing:
    """An object of the scene."""

    def __init__(self, kind: str, fields: dict[str, Any]) -> None:
        self.kind, self.fields = kind, fields
        self.rest_position = Data(fields.get("rest_position"))

    def getLinkPath(self) -> str:
        """By which a mapping finds it."""
        return f"@{self.fields['name']}"


class Node:
    """A node that notes what is put into it."""

    def __init__(self, name: str = "root") -> None:
        self.name = name
        self.things: list[Any] = []
        self.nodes: list[Node] = []
        self.gravity: list[float] = []
        self.time = Data(0.0)

    def addObject(self, what: Any, /, **fields: Any) -> Any:
        """A component, or a controller."""
        self.things.append(Thing(what, fields) if isinstance(what, str) else what)
        return self.things[-1]

    def addChild(self, what: Any) -> Any:
        """A new node, or one that is there."""
        self.nodes.append(Node(what) if isinstance(what, str) else what)
        return self.nodes[-1]

    def every(self) -> Iterator[Any]:
        """All things in it and below."""
        yield from self.things
        for node in self.nodes:
            yield from node.every()


class Controller:
    """What a controller derives from."""

    def __init__(self, name: str) -> None:
        self.name = name


def test_the_scene_has_the_numbers_in_the_plugins_fields(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = rods.write(tmp_path, "sofa")
    core = types.ModuleType("Sofa.Core")
    core.Controller = Controller  # type: ignore[attr-defined]
    package = types.ModuleType("Sofa")
    package.Core = core  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "Sofa", package)
    monkeypatch.setitem(sys.modules, "Sofa.Core", core)
    spec = importlib.util.spec_from_file_location("scene", tmp_path / "rod_sofa.py")
    assert spec is not None
    assert spec.loader is not None
    scene = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scene)
    assert "NOT RUN" in (scene.__doc__ or "")

    root = scene.createScene(Node())
    # the frames hang below both the base and the strains
    every = dict.fromkeys(thing for thing in root.every() if isinstance(thing, Thing))
    things = list(every)
    by_kind = {thing.kind: thing.fields for thing in things}
    for kind, fields in FIELDS.items():
        assert set(by_kind[kind]) <= fields
    beam = by_kind["BeamHookeLawForceFieldRigid"]
    axial, bending, side, twist = mjcf.stiffness_of(made["axis"]).mean(axis=0)
    told = [beam[name] for name in ("EA", "EIy", "EIz", "GI")]
    assert told == pytest.approx([axial, bending, side, twist])
    assert sum(beam["length"]) == pytest.approx(1e-3 * rods.LENGTH)

    strains = next(thing for thing in things if thing.fields.get("name") == "strains")
    controller = next(thing for thing in root.things if isinstance(thing, Controller))
    root.time.value = 5.0
    controller.onAnimateBeginEvent({})  # type: ignore[attr-defined]
    rest = np.array(strains.rest_position.value)
    # torsion, bending about the two axes across, elongation, shears
    last = [made["axis"][f"rest_{name}_1_per_mm"][-1] * 1e3 for name in ("twist", "curvature")]
    assert rest[10, :2] == pytest.approx(last)
    # the caps are rigid: what they turn is turned beside them, all of it
    turns = [made["ends"][key]["turn_rad"][-1] for key in KEYS]
    turned = float(np.sum(rest[:, 1] - last[1])) * 1e-3 * rods.LENGTH / scene.SECTIONS
    assert turned == pytest.approx(sum(turns))
    assert rest[0, 1] == pytest.approx(rest[-1, 1])
    assert beam["rayleighStiffness"] == scene.RAYLEIGH
    assert rest[10, 3] == pytest.approx(made["axis"]["rest_stretch"][-1] - 1)
    assert rest.shape == (scene.SECTIONS, 6)
    masses = [
        fields.fields["vertexMass"].split() for fields in things if fields.kind == "UniformMass"
    ]
    whole = (scene.SECTIONS + 1) * float(masses[0][0])
    mass = made["mass"]
    assert whole == pytest.approx(mass["section"]["per_length_kg_per_mm"] * rods.LENGTH)
    assert float(masses[1][0]) == pytest.approx(mass["cap"]["per_length_kg_per_mm"] * rods.CAP)
    assert [len(row) for row in masses] == [11, 11]
