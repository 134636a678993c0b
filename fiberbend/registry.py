"""From the effects that a case lists to those that the finite-element code knows."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from fem.effect import Effect
from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.elastic import Elastic
from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import BlockedTip, Clamp, Symmetry
from fem.effects.winding import SmearedWinding, Winding
from fem.program import Ramp
from fiberbend import bridge
from fiberbend.case import Case
from fiberbend.case_defaults import DEFAULT_LINES
from fiberbend.case_effects import (
    BlockedTipEffect,
    GravityEffect,
    PressureEffect,
    WindingEffect,
)
from geometry import winding as helices
from geometry.embed import EmbeddedFibers, embed, smear
from geometry.mesh import MeshData
from materials.laws import Material

_AXES = {"x": 0, "y": 1, "z": 2}


@dataclasses.dataclass(frozen=True)
class Parts:
    """What a scene is assembled from.

    Attributes:
        effects: the summands of the potential.
        ramps: the loads in the order of the case.
        materials: material of each region.
        fibers: the winding on the mesh, if there is one.
        smeared: the winding is smeared.
    """

    effects: list[Effect]
    ramps: list[Ramp]
    materials: dict[str, Material]
    fibers: EmbeddedFibers | None
    smeared: bool


def helix(effect: WindingEffect) -> helices.Winding:
    """The winding's curves as the geometry takes them; a width of zero is one line."""
    width = effect.width if effect.width is not None else bridge.fiber(effect.fiber).diameter
    lines = effect.lines if effect.lines is not None else DEFAULT_LINES
    return helices.Winding(effect.pattern, effect.pitch, width, lines if width > 0 else 1)


def build(case: Case, mesh: MeshData) -> Parts:
    """Effects and loads of a case on a mesh; what the case does not list does not exist."""
    specs = {
        region: spec for region, spec in dict(case.materials).items() if region in mesh.regions
    }
    materials = {region: bridge.material(spec) for region, spec in specs.items()}
    parts = Parts([Clamp()], [], materials, None, False)
    laws: dict[str, dict[str, dict[str, float]]] = {}
    for region, material in materials.items():
        laws.setdefault(material.law, {})[region] = dict(material.parameters)
    parts.effects.extend(Elastic(law, regions) for law, regions in laws.items())
    bulk = {region: m.bulk for region, m in materials.items() if m.bulk is not None}
    parts.effects.append(Incompressible(bulk or None))
    if mesh.half:
        parts.effects.append(Symmetry())
    for effect in case.effects:
        parts = _BUILDERS[type(effect)](effect, case, mesh, parts)
    return parts


def _pressure(effect: Any, case: Case, mesh: MeshData, parts: Parts) -> Parts:
    parts.effects.append(ChamberPressure())
    share = 2 if mesh.half else 1
    by_volume = effect.volume is not None
    output, solver = case.output, case.solver
    ramp = Ramp(
        ChamberPressure.scalar,
        target=effect.volume / share if by_volume else effect.to,
        drive="conjugate" if by_volume else "value",
        first=None if by_volume else solver.first_step,
        largest=None if by_volume else solver.max_step,
        stops=() if by_volume else tuple(output.at_pressures),
        at=tuple(output.at_angles),
        until=output.stop_at_angle,
    )
    parts.ramps.append(ramp)
    return parts


def _winding(effect: Any, case: Case, mesh: MeshData, parts: Parts) -> Parts:
    actuator, curves = bridge.dimensions(case.actuator), helix(effect)
    smeared = effect.representation == "smeared"
    fibers = smear(mesh, actuator, curves) if smeared else embed(mesh, actuator, curves)
    kind = SmearedWinding if smeared else Winding
    stiffness = bridge.fiber(effect.fiber).stiffness
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
    parts.ramps.append(Ramp(Gravity.scalar, 1.0, first=1.0))
    return parts


def _blocked_tip(effect: Any, case: Case, mesh: MeshData, parts: Parts) -> Parts:
    parts.effects.append(BlockedTip())
    return parts


_BUILDERS: dict[type[Any], Callable[[Any, Case, MeshData, Parts], Parts]] = {
    PressureEffect: _pressure,
    WindingEffect: _winding,
    GravityEffect: _gravity,
    BlockedTipEffect: _blocked_tip,
}
"""One line an effect."""
