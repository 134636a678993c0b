"""What a scene is assembled from: the effects of a case as the finite-element code takes them."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

from fem.effects.effect import Effect
from fem.effects.elastic import Elastic
from fem.effects.incompressible import Incompressible
from fem.march.records import Ramp
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.zones import borders, bounds, differing, zone_cases
from fiberbend.effects.effect import Built, Requests, Stretch
from fiberbend.models.model import MeshedModel
from geometry.bodies.zones import wound_part
from geometry.mesh.data import MeshData
from geometry.winding.segments import EmbeddedFibers
from materials.material import Material

_SURFACES = ("winding",)
"""Surfaces of a body on which effects lie that may differ along the length."""


@dataclasses.dataclass(frozen=True)
class SceneParts:
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

    def ramps(self, symmetry_factor: float) -> list[Ramp]:
        """The loads of the modelled part.

        Args:
            symmetry_factor: number of such parts that make up the whole actuator.
        """
        return [
            dataclasses.replace(ramp, target=ramp.target / symmetry_factor)
            if ramp.drive == "conjugate"
            else ramp
            for ramp in self.loads
        ]


def build(case: Case, mesh: MeshData, model: MeshedModel) -> SceneParts:
    """Effects and loads of a case on a mesh; what the case does not list does not exist.

    Args:
        case: the case.
        mesh: what is modelled.
        model: the model that solves it.
    """
    site = dataclasses.replace(convert.site(case), origin=model.origin(case))
    requests = convert.requests(case)
    materials = {part: item for part, item in site.materials.items() if part in mesh.regions}
    laws: dict[str, dict[str, dict[str, float]]] = {}
    for region, material in materials.items():
        laws.setdefault(material.law, {})[region] = dict(material.parameters)
    bulk = {region: m.bulk for region, m in materials.items() if m.bulk is not None}
    apart = differing(case)
    built = [
        Built(()) if effect.name in apart else effect.build(site, mesh, requests)
        for effect in case.effects
    ]
    built += [_along(case, name, mesh, requests) for name in sorted(apart)]
    wound = next((item for item in built if item.fibers is not None), None)
    return SceneParts(
        effects=[
            *model.supports(case, mesh),
            *(Elastic(law, regions) for law, regions in laws.items()),
            Incompressible(bulk or None),
            *(term for item in built for term in item.terms),
        ],
        loads=list(_asked(case, built, requests)),
        materials=materials,
        fibers=None if wound is None else wound.fibers,
        smeared=wound is not None and wound.smeared,
    )


def _along(case: Case, name: str, mesh: MeshData, requests: Requests) -> Built:
    """An effect that differs along the length, in every zone that has one."""
    stretches = []
    for number, (start, zone) in enumerate(zip(bounds(case), zone_cases(case), strict=False)):
        part = wound_part(mesh, borders(case), number, _SURFACES)
        stretches += [
            Stretch(effect, convert.site(zone), part, start)
            for effect in zone.effects
            if effect.name == name
        ]
    return stretches[0].effect.build_along(stretches, requests)


def _asked(case: Case, built: Sequence[Built], requests: Requests) -> Iterator[Ramp]:
    """The loads with the angles that are to be hit, whatever bends the body.

    What is put on before the pressure, such as its weight, is put on whole: only the pressure and
    what follows end at `stop_at_angle`.
    """
    pressures = [n for n, effect in enumerate(case.effects) if effect.inflation() is not None]
    first = min(pressures, default=0)
    for number, item in enumerate(built):
        until = requests.stop_at_angle if number >= first else None
        for ramp in item.ramps:
            yield dataclasses.replace(ramp, at=requests.at_angles, until=until)
