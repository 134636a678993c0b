"""What the values of a case must fulfil together."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from fiberbend.case import convert
from fiberbend.case.case import (
    ActuatorSpec,
    Case,
    Materials,
    Mesh,
    Output,
    Solver,
)
from fiberbend.case.symmetry import upside_down
from fiberbend.case.timed import checks as timed
from fiberbend.case.timed.spec import TimeSpec
from fiberbend.effects.effect import Draft, Effect, Inflation, keep_straight
from fiberbend.effects.records import mirror_breakers
from fiberbend.effects.table import EFFECTS
from fiberbend.models.choice import MODELS, choose_model
from fiberbend.reader.material_checks import material_problems
from fiberbend.reader.proportions import disproportions
from fiberbend.schema.problems import Problem
from fiberbend.schema.units import show

_END = 1 + 1e-9
"""A value at the end of a load is within it: units are factors, and a quotient rounds."""

if TYPE_CHECKING:
    from geometry.sections.size import MeshSize


_NO_ANGLE = "no angle is reached where {} keeps the actuator's bend, expected no value"
_MOST_STEPS = 100_000
"""Steps of a run that takes hours where one takes tenths of a second."""


@dataclasses.dataclass(frozen=True)
class ValidParts:
    """The parts of a case that are valid by themselves; the others are None or absent."""

    actuator: ActuatorSpec | None = None
    materials: Materials | None = None
    mesh: Mesh | None = None
    solver: Solver | None = None
    output: Output | None = None
    model: str | None = None
    zoned: bool = False
    time: TimeSpec | None = None
    effects: dict[int, Effect] = dataclasses.field(default_factory=dict)
    broken_effects: bool = False

    @classmethod
    def of(cls, case: Case) -> ValidParts:
        """All parts of a case."""
        return cls(
            case.actuator,
            case.materials,
            case.mesh,
            case.solver,
            case.output,
            case.model,
            case.zones is not None,
            case.time,
            dict(enumerate(case.effects)),
        )

    @property
    def inflation(self) -> Inflation | None:
        """How the chamber is loaded, by the first effect that loads it."""
        found = (effect.inflation() for effect in self.effects.values())
        return next((load for load in found if load is not None), None)

    def draft(self) -> Draft:
        """What effects are given when they are checked."""
        actuator = self.actuator
        fits = actuator is not None and not any(_dimensions(self))
        return Draft(
            actuator=convert.dimensions(actuator) if actuator is not None and fits else None,
            length=None if actuator is None else actuator.length,
            effects={
                f"effects.{index}.{effect.name}": effect for index, effect in self.effects.items()
            },
            moves=self.time is not None,
        )


def check(parts: ValidParts) -> Iterator[Problem]:
    """Every problem that lies in several values together.

    Args:
        parts: what is valid by itself.
    """
    yield from _dimensions(parts)
    yield from _effects(parts)
    draft = parts.draft()
    for path, effect in draft.effects.items():
        yield from effect.problems(path, draft)
    yield from _materials(parts)
    yield from _bends(parts)
    yield from disproportions(draft, parts.materials)
    yield from _density(parts)
    yield from _mesh(parts)
    yield from _solver(parts)
    yield from _output(parts)
    yield from _kept_straight(parts)
    if parts.time is not None and not parts.broken_effects:
        yield from timed.problems(parts.time, parts.inflation, parts.output)


def _dimensions(parts: ValidParts) -> Iterator[Problem]:
    from geometry.sections.table import inconsistencies

    if parts.actuator is not None:
        for name, text in inconsistencies(dict(parts.actuator)):
            yield Problem(f"actuator.{name}", text)


def _effects(parts: ValidParts) -> Iterator[Problem]:
    first: dict[str, int] = {}
    for index, effect in parts.effects.items():
        if effect.name in first and not effect.several:
            yield Problem(
                f"effects.{index}.{effect.name}",
                f"a second {effect.name}, expected one (the first is effects.{first[effect.name]})",
            )
        first.setdefault(effect.name, index)
    if not parts.broken_effects and not any(effect.load for effect in parts.effects.values()):
        names = " or ".join(name for name, effect in EFFECTS.items() if effect.load)
        yield Problem("effects", f"no load, expected {names}")


def _materials(parts: ValidParts) -> Iterator[Problem]:
    if parts.materials is None:
        return
    for part in ("wall", "floor", "sheath", "layer"):
        path, material = f"materials.{part}", getattr(parts.materials, part)
        if material is not None:
            yield from material_problems(path, material)
        if parts.actuator is not None:
            thickness = getattr(parts.actuator, part)
            if material is None and thickness is not None:
                yield Problem(path, f"missing, expected the material of actuator.{part}")
            if material is not None and thickness is None:
                yield Problem(path, f"no effect without actuator.{part}, expected no value")


def _bends(parts: ValidParts) -> Iterator[Problem]:
    """An angle that is asked of a pressure under which a section bends neither way."""
    if parts.broken_effects or parts.zoned or any(e.bends() for e in parts.effects.values()):
        return
    for index, effect in parts.effects.items():
        load = effect.inflation()
        if load is not None and load.angle is not None and _upside_down(parts):
            yield Problem(
                f"effects.{index}.{effect.name}.angle",
                f'"{show(load.angle, "angle")}", but no pressure bends this section: turned '
                "upside down it is its own image, in shape, materials and winding; expected a "
                "floor that differs from the wall, or a pressure by its value",
            )


def _upside_down(parts: ValidParts) -> bool:
    """Whether the section is its own image turned upside down."""
    if parts.actuator is None or parts.materials is None or any(_dimensions(parts)):
        return False
    regions = convert.dimensions(parts.actuator).one_material()
    specs = [getattr(parts.materials, region) for region in regions]
    if not regions or any(spec is None or any(material_problems("", spec)) for spec in specs):
        return False
    return upside_down(parts.actuator, parts.materials)


def _density(parts: ValidParts) -> Iterator[Problem]:
    if parts.materials is None or parts.broken_effects:
        return
    weighing = [effect.name for effect in parts.effects.values() if effect.needs_density]
    weighing += [] if parts.time is None else ["time"]
    for part in ("wall", "floor", "sheath", "layer"):
        path, material = f"materials.{part}", getattr(parts.materials, part)
        if material is None:
            continue
        if not weighing and material.density:
            needing = [name for name, effect in EFFECTS.items() if effect.needs_density]
            names = " or ".join([*needing, "time"])
            yield Problem(f"{path}.density", f"no effect without {names}, expected no value")
        if weighing and material.density is None:
            from materials.named.table import SOLIDS

            if material.name not in SOLIDS or SOLIDS[material.name].density is None:
                yield Problem(f"{path}.density", f"missing, expected a density for {weighing[0]}")
    given = [spec for spec in dict(parts.materials).values() if spec is not None]
    if weighing and all(spec.density == 0 for spec in given):
        yield Problem("materials", f"nothing has weight, expected a density for {weighing[0]}")


def _mesh(parts: ValidParts) -> Iterator[Problem]:
    if parts.mesh is None:
        return
    if parts.mesh.symmetry == "half":
        for reason in mirror_breakers(parts.effects.values()):
            yield Problem("mesh.symmetry", f'"half", expected auto or full: {reason}')
    # elsewhere the mesh depends on the model and its defaults, and is checked with these
    model = MODELS.get(parts.model or "")
    elements = None if model is None else model.elements()
    named = elements is not None and elements.takes_mesh_as_given
    if named and parts.actuator is not None and not any(_dimensions(parts)):
        size = convert.mesh_size(parts.mesh, half=True)
        yield from size_problems(parts.actuator, size, parts.draft().effects)


def mesh_problems(case: Case) -> Iterator[Problem]:
    """Why the mesh of a case's model cannot resolve its dimensions; a closed form has no mesh.

    Args:
        case: a checked and completed case.
    """
    model = choose_model(case)[0].elements()
    if model is not None:
        size = model.mesh_size(case, half=True)
        yield from size_problems(case.actuator, size, ValidParts.of(case).draft().effects)


def size_problems(
    actuator: ActuatorSpec, size: MeshSize, effects: Mapping[str, Effect]
) -> Iterator[Problem]:
    """Why a mesh cannot resolve the dimensions of an actuator.

    Args:
        actuator: its dimensions.
        size: fineness of the mesh.
        effects: by their paths; some need strips of the surface.
    """
    from geometry.sections.size import check_size, too_thin

    if size.axial > actuator.length:
        yield Problem(
            "mesh.axial",
            f'"{show(size.axial, "length")}", expected elements not longer than the chamber, '
            f'"{show(actuator.length, "length")}"',
        )
    dimensions = convert.dimensions(actuator)
    thin = list(too_thin(dimensions, size))
    for part, text in thin:
        yield Problem(f"actuator.{part}", text)
    for path, effect in effects.items():
        for key, text in effect.unresolved(size):
            yield Problem(f"{path}.{key}", text)
        strips = effect.strips()
        if strips is not None and not thin:
            try:
                check_size(dimensions, size, strips)
            except ValueError as error:
                yield Problem(path, str(error))


def _solver(parts: ValidParts) -> Iterator[Problem]:
    pressure, mesh = parts.inflation, parts.mesh
    if parts.solver and parts.solver.linear != "direct" and mesh and mesh.element == "tetrahedron":
        text = '"iterative", expected direct: pressures of tetrahedra couple layers'
        yield Problem("solver.linear", text)
    if parts.solver is None or parts.broken_effects:
        return
    given = {key: getattr(parts.solver, key) for key in ("first_step", "max_step")}
    for key, value in given.items():
        if value is not None and (pressure is None or pressure.to is None):
            yield Problem(
                f"solver.{key}", "no effect without a pressure to reach, expected no value"
            )
    yield from _endless(parts.solver, pressure, parts.output)
    first, largest = given["first_step"], given["max_step"]
    if first is not None and largest is not None and first > largest:
        yield Problem(
            "solver.first_step",
            f'"{show(first, "pressure")}", expected at most max_step, '
            f'"{show(largest, "pressure")}"',
        )


def _endless(
    solver: Solver, pressure: Inflation | None, output: Output | None
) -> Iterator[Problem]:
    """Steps so small that a run has no end."""
    if pressure is None:
        return
    angle = pressure.angle if output is None else pressure.angle or output.stop_at_angle
    for key, end, kind in (("max_step", pressure.to, "pressure"), ("max_turn", angle, "angle")):
        step = getattr(solver, key)
        if step is not None and end is not None and abs(end) > _MOST_STEPS * abs(step):
            yield Problem(
                f"solver.{key}",
                f'"{show(step, kind)}", expected at least a {_MOST_STEPS}th of '
                f'"{show(abs(end), kind)}"',
            )


def _output(parts: ValidParts) -> Iterator[Problem]:
    output = parts.output
    if output is None:
        return
    loads = [effect for effect in parts.effects.values() if effect.load]
    if output.stop_at_angle is not None and len(loads) == 1:
        for index, angle in enumerate(output.at_angles):
            if abs(angle) > abs(output.stop_at_angle) and angle * output.stop_at_angle > 0:
                yield Problem(
                    f"output.at_angles.{index}",
                    f'"{show(angle, "angle")}", expected an angle up to stop_at_angle, '
                    f'"{show(output.stop_at_angle, "angle")}"',
                )
    pressure = parts.inflation
    if parts.broken_effects:
        return
    if pressure is not None and pressure.angle is not None:
        yield from _up_to(pressure.angle, output)
    if output.measured is not None:
        from fiberbend.case.measured import what_is_wrong

        if pressure is None:
            wrong: str | None = "no effect without pressure, expected no value"
        else:
            wrong = what_is_wrong(output.measured, keep_straight(parts.effects.values()))
        if wrong is not None:
            yield Problem("output.measured", wrong)
    for index, value in enumerate(output.at_pressures):
        path = f"output.at_pressures.{index}"
        if pressure is None:
            yield Problem(path, "no effect without pressure, expected no value")
        elif pressure.to is None:
            yield Problem(path, "no effect where the pressure is found, expected no value")
        elif not 0 < value / pressure.to <= _END:
            yield Problem(
                path,
                f'"{show(value, "pressure")}", expected a pressure between zero and '
                f'"{show(pressure.to, "pressure")}"',
            )


def _kept_straight(parts: ValidParts) -> Iterator[Problem]:
    """Angles asked of an actuator that some effect keeps straight.

    Between roof and post a tip turns a little, and the run says what it has not reached.
    """
    effects = parts.draft().effects
    holds = next((path for path, effect in effects.items() if effect.keeps_straight()), "")
    for path, effect in effects.items():
        load = effect.inflation()
        if holds and load is not None and load.angle is not None:
            yield Problem(f"{path}.angle", _NO_ANGLE.format(holds))
    fixes = next((path for path, e in effects.items() if e.fixes_angle()), "")
    if fixes and parts.output is not None:
        if parts.output.stop_at_angle is not None:
            yield Problem("output.stop_at_angle", _NO_ANGLE.format(fixes))
        for index, _ in enumerate(parts.output.at_angles):
            yield Problem(f"output.at_angles.{index}", _NO_ANGLE.format(fixes))


def _up_to(end: float, output: Output) -> Iterator[Problem]:
    """Requests of a run that ends at a bending angle."""
    if output.stop_at_angle is not None:
        yield Problem(
            "output.stop_at_angle", "no effect where the pressure has an angle, expected no value"
        )
    for index, angle in enumerate(output.at_angles):
        if not 0 < angle / end <= _END:
            yield Problem(
                f"output.at_angles.{index}",
                f'"{show(angle, "angle")}", expected an angle between zero and '
                f'"{show(end, "angle")}"',
            )
