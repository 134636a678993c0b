"""From a case to the paper's closed forms: the analytical lines that are drawn beside any run."""

from __future__ import annotations

from typing import Any

from analytic.bending import Hemicircle
from analytic.stress import Stress, wound
from fiberbend.case import convert
from fiberbend.case.case import Case, MaterialSpec
from fiberbend.effects.records import tip_strips
from fiberbend.models import lines

SHAPE = "hemicircle"
"""The section that has a closed form."""
LIMITING = 10.0
"""Stretching stiffness of floor and layer over the wall's from which y = 0 counts as inextensible;
the paper's combined base has 50 times the wall's, a floor of the wall's rubber 0.7 times."""


def no_analytic(case: Case) -> str | None:
    """Why no analytical line stands for a case, or None where all do."""
    if case.zones is not None:
        return "the closed form is of one winding and one floor all along, not of zones"
    section = case.actuator.section
    if section != SHAPE:
        return f"the closed form of bending is for a {SHAPE}, not for a {section}"
    for effect in case.effects:
        if reason := effect.no_closed_form():
            return reason
    if not any(effect.fixes_circumference() for effect in case.effects):
        return "no winding fixes the circumference, as the closed form assumes"
    stiffness = _stiffness(case)
    share = (stiffness["floor"] + stiffness.get("layer", 0.0)) / stiffness["wall"]
    if share < LIMITING:
        return (
            f"floor and layer together stretch only {share:.2g} times as hard as the wall, "
            f"{LIMITING:g} times expected: y = 0 is no inextensible line"
        )
    return None


def analytic_curves(case: Case) -> dict[str, Hemicircle]:
    """The analytical models of a case; none where `no_analytic` has a reason.

    Returns:
        'zero-fit': eq. (19) with the wall's own law and the sheath, nothing fitted;
        'winding': the same with the pressure acting on all inside the winding;
        'paper': eq. (19) without its extra L and with the paper's μ̄, whatever the case's rubber.
        A floor that limits the stretch by itself enters as the wall's rubber: its own stiffness
        is what keeps the length of y = 0. Any other floor has its own law.
    """
    if no_analytic(case) is not None:
        return {}
    materials, sheath = case.materials, case.actuator.sheath
    size = dimensions(case)
    own: dict[str, Any] = {"stress": _stress(materials.wall)}
    if materials.floor is not None and not floor_limits(case):
        own["floor_stress"] = _stress(materials.floor)
    if sheath is not None and materials.sheath is not None:
        own |= {"sheath": sheath, "sheath_stress": _stress(materials.sheath)}
    return {
        lines.ZERO_FIT: Hemicircle(*size, **own),
        lines.WINDING: Hemicircle(*size, **own, acts="winding"),
        lines.PAPER: Hemicircle(*size),
    }


def assumptions(case: Case) -> list[str]:
    """What of a case the closed form leaves out, one sentence each."""
    remarks = [text for effect in case.effects for text in effect.assumed()]
    if floor_limits(case):
        remarks.append("the floor enters as rubber of the wall on an inextensible line at y = 0")
    specs = dict(case.materials).values()
    if any(spec is not None and convert.material(spec).bulk is not None for spec in specs):
        remarks.append("every material counts as incompressible")
    return remarks


def lever_arm(case: Case) -> float:
    """L_f in mm: from the end of the chamber to the middle of the post, or the whole cap."""
    strips = tip_strips(case.effects)
    return case.actuator.cap - (strips.post_length / 2 if strips is not None else 0.0)


def dimensions(case: Case) -> tuple[float, float, float, float]:
    """(a, b, t, L) of a hemicircle, mm."""
    actuator = case.actuator
    radius, floor = actuator.radius, actuator.floor
    assert radius is not None
    assert floor is not None
    return radius, floor, actuator.wall, actuator.length


def _stress(spec: MaterialSpec) -> Stress:
    """Axial stress of a material whose circumference is fixed."""
    return wound(convert.material(spec).principal)


def floor_limits(case: Case) -> bool:
    """The floor alone is stiff enough to be the inextensible line."""
    stiffness = _stiffness(case)
    return stiffness["floor"] >= LIMITING * stiffness["wall"]


def _stiffness(case: Case) -> dict[str, float]:
    """Shear modulus times area of each region of a hemicircle, at rest, N."""
    areas = convert.dimensions(case.actuator).region_areas()
    specs = {part: spec for part, spec in dict(case.materials).items() if spec is not None}
    return {
        part: convert.material(specs[part]).initial_shear_modulus * areas[part] for part in areas
    }
