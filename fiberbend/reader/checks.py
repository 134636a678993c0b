"""What the values of a case must fulfil together."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

from fiberbend.case import convert
from fiberbend.case.case import (
    Actuator,
    Case,
    Material,
    Materials,
    Mesh,
    Output,
    Solver,
)
from fiberbend.case.measured import what_is_wrong
from fiberbend.effects.clearance import wrong_obstacles
from fiberbend.effects.table import (
    BlockedTipEffect,
    ContactEffect,
    Effect,
    Fiber,
    GravityEffect,
    HoopsEffect,
    PressureEffect,
    WindingEffect,
    hold_straight,
)
from fiberbend.models.choice import mirror_breakers
from fiberbend.models.mesh_size import misfitting
from fiberbend.schema.problems import Problem, found
from fiberbend.schema.units import show
from materials.laws.table import LAWS


@dataclasses.dataclass
class Parts:
    """The parts of a case that are valid by themselves; the others are None or absent."""

    actuator: Actuator | None = None
    materials: Materials | None = None
    mesh: Mesh | None = None
    solver: Solver | None = None
    output: Output | None = None
    model: str | None = None
    effects: dict[int, Effect] = dataclasses.field(default_factory=dict)
    broken_effects: bool = False

    @classmethod
    def of(cls, case: Case) -> Parts:
        """All parts of a case."""
        return cls(
            case.actuator,
            case.materials,
            case.mesh,
            case.solver,
            case.output,
            case.model,
            dict(enumerate(case.effects)),
        )

    def find(self, kind: type[Any]) -> tuple[str, Any]:
        """Path and value of the first effect of a class; the value is None where there is none."""
        for index, effect in self.effects.items():
            if isinstance(effect, kind):
                return f"effects.{index}.{effect.name}", effect
        return "", None


def check(parts: Parts) -> Iterator[Problem]:
    """Every problem that lies in several values together.

    Args:
        parts: what is valid by itself.
    """
    yield from _section(parts)
    yield from _effects(parts)
    yield from _pressure(parts)
    yield from _winding(parts)
    yield from _materials(parts)
    yield from _gravity(parts)
    yield from _contact(parts)
    yield from _mesh(parts)
    yield from _solver(parts)
    yield from _output(parts)


def _section(parts: Parts) -> Iterator[Problem]:
    from geometry.sections.profiles import misfits

    if parts.actuator is not None:
        for name, text in misfits(dict(parts.actuator)):
            yield Problem(f"actuator.{name}", text)


def _effects(parts: Parts) -> Iterator[Problem]:
    first: dict[str, int] = {}
    for index, effect in parts.effects.items():
        if effect.name in first:
            yield Problem(
                f"effects.{index}.{effect.name}",
                f"a second {effect.name}, expected one (the first is effects.{first[effect.name]})",
            )
        first.setdefault(effect.name, index)
    if not parts.broken_effects and not any(effect.load for effect in parts.effects.values()):
        yield Problem("effects", "no load, expected pressure or gravity")


def _pressure(parts: Parts) -> Iterator[Problem]:
    path, pressure = parts.find(PressureEffect)
    if pressure is None:
        return
    given = [key for key in ("to", "volume", "angle") if getattr(pressure, key) is not None]
    if not given:
        yield Problem(path, 'nothing to reach, expected to, such as "200 kPa", volume or angle')
    for key in given[1:]:
        yield Problem(f"{path}.{key}", f"{given[0]} is given too, expected one of them")


def _winding(parts: Parts) -> Iterator[Problem]:
    path, winding = parts.find(WindingEffect)
    if winding is None:
        return
    hoops, both = parts.find(HoopsEffect)
    if both is not None:
        yield Problem(hoops, f"{path} holds the circumference already, expected one of them")
    if parts.actuator is not None and winding.pitch > parts.actuator.length:
        yield Problem(
            f"{path}.pitch",
            f"{_length(winding.pitch)}, expected a pitch not longer than the chamber, "
            f"{_length(parts.actuator.length)}",
        )
    if winding.representation == "smeared":
        for key in ("width", "lines"):
            if getattr(winding, key) is not None:
                yield Problem(f"{path}.{key}", "no effect on a smeared winding, expected no value")
    elif winding.width == 0 and (winding.lines or 1) > 1:
        yield Problem(f"{path}.lines", f"{winding.lines}, expected 1 line where the width is zero")
    yield from _fiber(f"{path}.fiber", winding.fiber)


def _fiber(path: str, fiber: Fiber) -> Iterator[Problem]:
    own = ("modulus", "diameter", "radius_factor")
    if fiber.name is None:
        for key in own[:2]:
            if getattr(fiber, key) is None:
                yield Problem(f"{path}.{key}", f"missing, expected the {key} of an unnamed fiber")
        return
    from materials.fiber import FIBERS

    if fiber.name not in FIBERS:
        names = ", ".join(FIBERS)
        yield Problem(path, f"{found(fiber.name)}, expected {names}, or modulus and diameter")
    for key in own:
        if getattr(fiber, key) is not None:
            yield Problem(f"{path}.{key}", "no effect on a named fiber, expected no value")


def _materials(parts: Parts) -> Iterator[Problem]:
    if parts.materials is None:
        return
    for part in ("wall", "floor", "sheath", "layer"):
        path, material = f"materials.{part}", getattr(parts.materials, part)
        if material is not None:
            yield from _material(path, material)
        if parts.actuator is not None:
            thickness = getattr(parts.actuator, part)
            if material is None and thickness is not None:
                yield Problem(path, f"missing, expected the material of actuator.{part}")
            if material is not None and thickness is None:
                yield Problem(path, f"no effect without actuator.{part}, expected no value")


def _material(path: str, material: Material) -> Iterator[Problem]:
    from materials.named import NAMED

    given = material.coefficients
    if material.name is not None:
        if material.name not in NAMED:
            yield Problem(path, f"{found(material.name)}, expected {', '.join(NAMED)}, or a law")
        for key in [*(["law"] if material.law else []), *given]:
            yield Problem(f"{path}.{key}", "no effect on a named material, expected no value")
        return
    if material.law is None:
        yield Problem(path, "neither name nor law, expected one of them")
        return
    law = LAWS[material.law]
    problems = [
        *((key, f"missing, expected a coefficient of {law.name}") for key in law.missing(given)),
        *((key, f"no effect on {law.name}, expected no value") for key in law.unknown(given)),
        *((key, f"no effect without {term}, expected no value") for key, term in law.idle(given)),
        *law.refusals(given),
    ]
    for key, text in problems:
        yield Problem(f"{path}.{key}", text)
    if not problems:
        try:
            convert.material(material)
        except ValueError as error:
            yield Problem(path, str(error))


def _gravity(parts: Parts) -> Iterator[Problem]:
    _, gravity = parts.find(GravityEffect)
    if parts.materials is None or parts.broken_effects:
        return
    for part in ("wall", "floor", "sheath", "layer"):
        path, material = f"materials.{part}", getattr(parts.materials, part)
        if material is None:
            continue
        if gravity is None and material.density is not None:
            yield Problem(f"{path}.density", "no effect without gravity, expected no value")
        if gravity is not None and material.density is None:
            from materials.named import NAMED

            if material.name not in NAMED or NAMED[material.name].density is None:
                yield Problem(f"{path}.density", "missing, expected a density for gravity")


def _contact(parts: Parts) -> Iterator[Problem]:
    path, contact = parts.find(ContactEffect)
    if contact is None:
        return
    other, tip = parts.find(BlockedTipEffect)
    for name in ("roof", "post"):
        if tip is not None and getattr(contact, name) is not None:
            yield Problem(f"{path}.{name}", f"{other} holds it already, expected one of them")
    actuator = parts.actuator if not any(_section(parts)) else None
    yield from wrong_obstacles(actuator, path, contact)


def _mesh(parts: Parts) -> Iterator[Problem]:
    if parts.mesh is None:
        return
    if parts.mesh.symmetry == "half":
        for reason in mirror_breakers(parts.effects.values()):
            yield Problem("mesh.symmetry", f'"half", expected auto or full: {reason}')
    # elsewhere the mesh depends on the model and its defaults, and is checked with these
    if parts.model == "body" and parts.actuator is not None and not any(_section(parts)):
        size = convert.mesh_size(parts.mesh, half=True)
        path, tip = parts.find(BlockedTipEffect)
        path, tip = (path, tip) if tip is not None else parts.find(ContactEffect)
        yield from misfitting(parts.actuator, size, path, tip)


def _solver(parts: Parts) -> Iterator[Problem]:
    _, pressure = parts.find(PressureEffect)
    if parts.solver is None or parts.broken_effects:
        return
    given = {key: getattr(parts.solver, key) for key in ("first_step", "max_step")}
    for key, value in given.items():
        if value is not None and (pressure is None or pressure.to is None):
            yield Problem(
                f"solver.{key}", "no effect without a pressure to reach, expected no value"
            )
    first, largest = given["first_step"], given["max_step"]
    if first is not None and largest is not None and first > largest:
        yield Problem(
            "solver.first_step",
            f'"{show(first, "pressure")}", expected at most max_step, '
            f'"{show(largest, "pressure")}"',
        )


def _output(parts: Parts) -> Iterator[Problem]:
    output = parts.output
    if output is None:
        return
    if output.stop_at_angle is not None:
        for index, angle in enumerate(output.at_angles):
            if abs(angle) > abs(output.stop_at_angle) and angle * output.stop_at_angle > 0:
                yield Problem(
                    f"output.at_angles.{index}",
                    f'"{show(angle, "angle")}", expected an angle up to stop_at_angle, '
                    f'"{show(output.stop_at_angle, "angle")}"',
                )
    _, pressure = parts.find(PressureEffect)
    if parts.broken_effects:
        return
    if pressure is not None and pressure.angle is not None:
        yield from _up_to(pressure.angle, output)
    if output.measured is not None:
        if pressure is None:
            wrong: str | None = "no effect without pressure, expected no value"
        else:
            wrong = what_is_wrong(output.measured, hold_straight(parts.effects.values()))
        if wrong is not None:
            yield Problem("output.measured", wrong)
    for index, value in enumerate(output.at_pressures):
        path = f"output.at_pressures.{index}"
        if pressure is None:
            yield Problem(path, "no effect without pressure, expected no value")
        elif pressure.to is None:
            yield Problem(path, "no effect where the pressure is found, expected no value")
        elif not 0 < value / pressure.to <= 1:
            yield Problem(
                path,
                f'"{show(value, "pressure")}", expected a pressure between zero and '
                f'"{show(pressure.to, "pressure")}"',
            )


def _up_to(end: float, output: Output) -> Iterator[Problem]:
    """Requests of a run that ends at a bending angle."""
    if output.stop_at_angle is not None:
        yield Problem(
            "output.stop_at_angle", "no effect where the pressure has an angle, expected no value"
        )
    for index, angle in enumerate(output.at_angles):
        if not 0 < angle / end <= 1:
            yield Problem(
                f"output.at_angles.{index}",
                f'"{show(angle, "angle")}", expected an angle between zero and '
                f'"{show(end, "angle")}"',
            )


def _length(value: float) -> str:
    return f'"{show(value, "length")}"'
