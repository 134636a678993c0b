"""The obstacles of a case as the finite-element code takes them, and the pace of its march."""

from __future__ import annotations

import dataclasses
import math

from fem.effects.contact import Contact, Cylinder, Obstacle, Plane
from fem.march.records import Rules
from fem.solver.newton import Settings
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.effects import table
from fiberbend.effects.table import ContactEffect
from fiberbend.models.closed_form import held

SURFACES = {"roof": ("roof",), "post": ("post",)}
EVERYWHERE = ("outer", "tip")
"""Surfaces that may touch an obstacle anywhere in space."""

STIFFNESS = 100.0
"""Obstacles are so many times as stiff as what touches them."""
ITERATIONS = 25
SHARPER = 0.01
"""Factor on the tolerance of forces."""
HELD_TURN = 0.05
"""Turn in the first step of a body between roof and post, rad."""
HELD_GROWTH = 3.0


def obstacles(case: Case) -> dict[str, Obstacle]:
    """The rigid bodies of a case by their names, in space."""
    contact = case.find(ContactEffect)
    return {n: _placed(case, o) for n, o in contact.obstacles.items()} if contact else {}


def _placed(case: Case, item: table.Obstacle) -> Obstacle:
    actuator = convert.dimensions(case.actuator)
    if isinstance(item, table.Roof):
        return Plane((0.0, actuator.outer_top + item.gap, 0.0), (0.0, -1.0, 0.0))
    if isinstance(item, table.Post):
        return Plane((0.0, actuator.outer_bottom - item.gap, 0.0), (0.0, 1.0, 0.0))
    if isinstance(item, table.Plane):
        return Plane(item.point, item.normal)
    return Cylinder(item.center, item.radius)


def stiffness(case: Case) -> float:
    """Pressure per depth with which the obstacles of a case yield, MPa/mm.

    What touches them, a layer of thickness h and Young's modulus E, yields by h/E times the
    pressure; the obstacle by a hundredth of that. Between roof and post, where nothing else yields,
    E is the wall's, also under a softer sheath.
    """
    contact = case.find(ContactEffect)
    if contact is not None and contact.stiffness is not None:
        return contact.stiffness
    actuator, materials = case.actuator, case.materials
    thickness, spec = actuator.wall, materials.wall
    if actuator.sheath is not None:
        thickness = actuator.sheath
        if materials.sheath is not None and not held(case):
            spec = materials.sheath
    return STIFFNESS * 3 * convert.material(spec).initial_shear_modulus / thickness


def effects(case: Case) -> list[Contact]:
    """One effect for each obstacle of a case."""
    k = stiffness(case)
    return [
        Contact(name, item, SURFACES.get(name, EVERYWHERE), k)
        for name, item in obstacles(case).items()
    ]


def settings(case: Case, usual: Settings) -> Settings:
    """More iterations where points of a surface have to find out whether they touch.

    Forces of contact are small beside those in the fibers, on which the tolerance is measured.
    """
    if case.find(ContactEffect) is None:
        return usual
    return dataclasses.replace(usual, iterations=ITERATIONS, tolerance=SHARPER * usual.tolerance)


def pace(case: Case, usual: Rules) -> Rules:
    """Rules of a march with obstacles.

    What touches is found in some six iterations however short the step is: they do not shorten it.
    A body that is held hardly turns from the start, and its steps may grow fast. Touch bends every
    curve: two states point better than three, and no volume is unexpected.
    """
    contact = case.find(ContactEffect)
    if contact is None:
        return usual
    first, grow = (HELD_TURN, HELD_GROWTH) if held(case) else (usual.turn, usual.grow)
    return dataclasses.replace(
        usual,
        easy=10,
        slow=16,
        grow=grow,
        memory=2,
        first_turn=min(usual.first_turn, first),
        jump=math.inf,
    )
