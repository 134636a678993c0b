"""The actuator of a case at rest, before anything is solved: what there is, and a picture."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from fiberbend.case import convert, zones
from fiberbend.case.case import Case
from fiberbend.models.choice import choose_model
from fiberbend.schema.problems import CaseError, Problem

if TYPE_CHECKING:
    from fiberbend.drawing.blueprint import Blueprint

_FINE = 3
"""Elements through a thickness, so that arcs are drawn round."""


def facts(case: Case) -> Iterator[tuple[str, str]]:
    """What an actuator is, a name and words each; nothing is solved.

    Args:
        case: the case.
    """
    given, actuator = case.actuator, convert.dimensions(case.actuator)
    yield "section", f"{given.section}, {_chamber(case)}"
    yield "chamber", f"{given.length:g} mm long, {actuator.chamber_volume / 1e3:.3g} mL"
    for name, spec in case.materials:
        thickness = getattr(given, name)
        if spec is None or thickness is None:
            continue
        material = convert.material(spec)
        parameters = ", ".join(f"{key} {value:g}" for key, value in material.parameters.items())
        plain = f"{material.law} ({spec.source})" if spec.source else material.law
        what = f"{spec.name} ({material.law}: {parameters})" if spec.name else plain
        yield name, f"{thickness:g} mm, {what}"
    yield "caps", f"{given.cap:g} mm each; {actuator.total_length:g} mm in all"
    words = _winding(case)
    if words:
        yield "winding", words
    for number, text in enumerate(zones.words(case), start=1):
        yield f"zone {number}", text
    for name in convert.obstacle_shapes(case):
        yield "obstacle", name
    model, why = choose_model(case)
    yield "model", f"{model.name} ({why})"


def blueprint(case: Case) -> Blueprint:
    """The picture of an actuator at rest, ready to be saved.

    Args:
        case: the case.

    Raises:
        CaseError: the section cannot be drawn.
    """
    import dataclasses

    from fiberbend.drawing.blueprint import Blueprint
    from fiberbend.results.at_rest import body_at_rest, threads
    from fiberbend.results.scenery import scenery
    from geometry.bodies.extrude import section_quadrilaterals

    actuator = convert.dimensions(case.actuator)
    size = dataclasses.replace(convert.mesh_size(case.mesh, True), section=_FINE)
    try:
        section = section_quadrilaterals(actuator, size)
    except ValueError as error:
        raise CaseError([Problem("actuator", str(error))]) from None
    turns = case.turns
    return Blueprint(
        title=case.title,
        section=section,
        length=case.actuator.length,
        cap=case.actuator.cap,
        width=_chamber(case),
        curves=convert.curves(case),
        winding=_winding(case),
        pitch=None if turns is None else turns.pitch,
        scenery=scenery(case),
        space=body_at_rest(case),
        threads=threads(case),
    )


def _chamber(case: Case) -> str:
    """Its dimensions in words."""
    names = ("radius", "width", "height")
    values = {name: getattr(case.actuator, name) for name in names}
    return ", ".join(f"{name} {value:g} mm" for name, value in values.items() if value is not None)


def _winding(case: Case) -> str:
    """The winding in words; empty without one."""
    turns = case.turns
    if turns is None:
        return ""
    kind = "every turn by itself" if turns.discrete else "spread over its surface"
    if turns.bulges:
        kind += ", bulging as in its cell"
    if turns.pitch is None:
        return f"threads by families, {kind}"
    count = case.actuator.length / turns.pitch
    return f"pitch {turns.pitch:g} mm, {count:.3g} turns, {kind}"
