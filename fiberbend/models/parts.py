"""From the effects that a case lists to those that the finite-element code knows."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.elastic import Elastic
from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import BlockedTip, Clamp, HeldStraight, Symmetry, TwofoldAxis
from fem.effects.winding import SmearedWinding, Winding
from fem.march.records import Ramp
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.effects import contact
from fiberbend.effects.table import (
    BlockedTipEffect,
    ContactEffect,
    GravityEffect,
    PressureEffect,
    StraightEffect,
    WindingEffect,
)
from fiberbend.reader.defaults import DEFAULT_LINES
from geometry.mesh.data import MeshData
from geometry.winding import helix as helices
from geometry.winding.embed import EmbeddedFibers, embed, smear
from materials.laws import Material

_AXES = {"x": 0, "y": 1, "z": 2}


@dataclasses.dataclass(frozen=True)
class Parts:
    """What a scene is assembled from.

    Attributes:
        effects: the summands of the potential.
        loads: the loads in the order of the case, those of the whole actuator.
        materials: material of each region.
        fibers: the winding on the mesh, if there is one.
        smeared: the winding is smeared.
    """

    effects: list[Effect]
    loads: list[Ramp]
    materials: dict[str, Material]
    fibers: EmbeddedFibers | None
    smeared: bool

    def ramps(self, copies: float) -> list[Ramp]:
        """The loads for a model of which the whole actuator is so many copies."""
        return [
            dataclasses.replace(ramp, target=ramp.target / copies)
            if ramp.drive == "conjugate"
            else ramp
            for ramp in self.loads
        ]


def helix(effect: WindingEffect) -> helices.Winding:
    """The winding's curves as the geometry takes them; a width of zero is one line."""
    width = effect.width if effect.width is not None else convert.fiber(effect.fiber).diameter
    lines = effect.lines if effect.lines is not None else DEFAULT_LINES
    return helices.Winding(effect.pattern, effect.pitch, width, lines if width > 0 else 1)


def build(case: Case, mesh: MeshData, model: str) -> Parts:
    """Effects and loads of a case on a mesh; what the case does not list does not exist.

    Args:
        case: the case.
        mesh: what is modelled.
        model: "section", "cell" or "body".
    """
    specs = {
        region: spec for region, spec in dict(case.materials).items() if region in mesh.regions
    }
    materials = {region: convert.material(spec) for region, spec in specs.items()}
    parts = Parts(_supports(case, mesh, model), [], materials, None, False)
    laws: dict[str, dict[str, dict[str, float]]] = {}
    for region, material in materials.items():
        laws.setdefault(material.law, {})[region] = dict(material.parameters)
    parts.effects.extend(Elastic(law, regions) for law, regions in laws.items())
    bulk = {region: m.bulk for region, m in materials.items() if m.bulk is not None}
    parts.effects.append(Incompressible(bulk or None))
    for effect in case.effects:
        parts = _BUILDERS[type(effect)](effect, case, mesh, parts)
    return parts


def twisting(case: Case) -> bool:
    """Whether the winding may twist the body."""
    winding = case.find(WindingEffect)
    return winding is not None and winding.pattern != "double-helix"


def _supports(case: Case, mesh: MeshData, model: str) -> list[Effect]:
    """What holds the model by its nature: the clamp of a body, planes and axes of symmetry."""
    if model == "body":
        return [Clamp(), *([Symmetry()] if mesh.half else [])]
    if model == "section":
        return [TwofoldAxis() if twisting(case) else Symmetry()]
    if mesh.half:
        return [Symmetry(), Symmetry("section_root", 2), Symmetry("section_tip", 2)]
    return []


def _pressure(effect: Any, case: Case, mesh: MeshData, parts: Parts) -> Parts:
    parts.effects.append(ChamberPressure())
    output, solver = case.output, case.solver
    if effect.volume is not None:
        drive, target = "conjugate", effect.volume
    elif effect.angle is not None:
        drive, target = "control", effect.angle
    else:
        drive, target = "value", effect.to
    ramp = Ramp(
        ChamberPressure.scalar,
        target=target,
        drive=drive,
        first=solver.first_step if drive == "value" else None,
        largest=solver.max_step if drive == "value" else None,
        stops=tuple(output.at_pressures) if drive == "value" else (),
        at=tuple(output.at_angles),
        until=output.stop_at_angle,
    )
    parts.loads.append(ramp)
    return parts


def _winding(effect: Any, case: Case, mesh: MeshData, parts: Parts) -> Parts:
    actuator, curves = convert.dimensions(case.actuator), helix(effect)
    smeared = effect.representation == "smeared"
    fibers = smear(mesh, actuator, curves) if smeared else embed(mesh, actuator, curves)
    kind = SmearedWinding if smeared else Winding
    stiffness = convert.fiber(effect.fiber).stiffness
    parts.effects.append(kind(fibers, stiffness, effect.tension_only))
    return dataclasses.replace(parts, fibers=fibers, smeared=smeared)


def _gravity(effect: Any, case: Case, mesh: MeshData, parts: Parts) -> Parts:
    direction = np.zeros(3)
    direction[_AXES[effect.direction[1]]] = 1.0 if effect.direction[0] == "+" else -1.0
    density = {
        region: m.mass_density
        for region, m in parts.materials.items()
        if m.mass_density is not None
    }
    load = Gravity(density, tuple(effect.acceleration * direction))
    parts.effects.append(load)
    parts.loads.append(Ramp(Gravity.scalar, 1.0, first=1.0))
    return parts


def _blocked_tip(effect: Any, case: Case, mesh: MeshData, parts: Parts) -> Parts:
    parts.effects.append(BlockedTip())
    return parts


def _contact(effect: Any, case: Case, mesh: MeshData, parts: Parts) -> Parts:
    parts.effects.extend(contact.effects(case))
    return parts


def _straight(effect: Any, case: Case, mesh: MeshData, parts: Parts) -> Parts:
    parts.effects.append(HeldStraight(effect.stretch == "held"))
    return parts


_BUILDERS: dict[type[Any], Callable[[Any, Case, MeshData, Parts], Parts]] = {
    PressureEffect: _pressure,
    WindingEffect: _winding,
    GravityEffect: _gravity,
    BlockedTipEffect: _blocked_tip,
    ContactEffect: _contact,
    StraightEffect: _straight,
}
"""One line an effect."""
