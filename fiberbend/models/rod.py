"""`model: rod`: the actuator as a line, by the law of its section and of its caps."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import sheared, wound
from fiberbend.case.zones import zone_cases
from fiberbend.columns import MIDDLE, OBSTACLES, SOLVED, TIMED
from fiberbend.columns import ZONES as OF_ZONES
from fiberbend.effects.blocked_tip import OF_STRIPS
from fiberbend.effects.effect import (
    CHAMBER,
    ENDS,
    SIDE,
    THREAD,
    TURNS,
    TWIST,
    VOLUME,
    WOUND,
    ZONES,
)
from fiberbend.effects.records import LINE, MOTION
from fiberbend.models.ends import AT_ENDS
from fiberbend.models.model import ModelKind, Objection, SlenderModel

_MEASURED = ("hemicircle",)
"""Sections with which it is beside a body (docs/evidence/rod.md)."""
_ROUNDING = 1e-9
TOUCHED = "what a rod touches that twists by itself is not known"
MOVED = "a motion is known of sections that keep to their plane"
_SECTION_S, _CELL_S, _ABOUT_S = 8.0, 15.0, 30.0
"""Seconds for the table of a section and of a cell, of the baseline (`fiberbend table`), and for
the law of a section that twists."""


class Rod(SlenderModel):
    """A geometrically exact rod: a uniform bend anew in every piece, under weights and loads."""

    name = "rod"
    offers = frozenset(
        {CHAMBER, VOLUME, WOUND, THREAD, TURNS, TWIST, SIDE, LINE, ENDS, MOTION, ZONES}
    )
    fills = ModelKind.fills | {MIDDLE, SOLVED, OBSTACLES, TIMED, OF_ZONES}
    ends = True
    agreement = 2.0
    start_s = 1.0
    pictures_s = (5.0, 1.0)
    turn = math.radians(10)
    pieces, cap_pieces = 48, 4
    step_s = 0.02

    def unknowns(self, case: Case) -> int:
        """A stretch and a curvature each, out of its plane twice as many; and where it shears."""
        across = any(effect.mirror_breaker() for effect in case.acting)
        twists = not all(wound(zone).plane for zone in zone_cases(case))
        planes = 2 if across or twists else 1
        each = planes * (3 if sheared(case) and not twists else 2)
        return each * (self.pieces + 2 * self.cap_pieces)

    def law_seconds(self, case: Case) -> float:
        """Of a cell more than of a section, and of what twists by itself most."""
        if not wound(case).plane:
            return _ABOUT_S
        turns = case.turns
        return _CELL_S if turns is not None and turns.discrete else _SECTION_S

    def limits(self, case: Case) -> Iterator[Objection]:
        """No law of its section reaches there."""
        load = case.inflation
        if load is None:
            text = "the law of a section reaches from rest to a pressure, a volume or an angle"
            yield "effects", f"{text}, expected effect pressure with one"
        if not wound(case).plane:
            yield from self._limits_of_twisting(case)
        if case.output.fields and "fields" in case.output.model_fields_set:
            yield "output.fields", "a rod has no fields: its sections are known by their law alone"

    def _limits_of_twisting(self, case: Case) -> Iterator[Objection]:
        """Its law is about the free states at pressures from rest on, and was put beside few."""
        for index, effect in enumerate(case.effects):
            path, own = f"effects.{index}.{effect.name}", effect.inflation()
            if effect.touches() or effect.strips() is not None:
                yield path, TOUCHED
            if own is not None and own.volume is not None:
                text = (
                    "the law of a section that twists by itself reaches to a pressure or an angle"
                )
                yield f"{path}.volume", f"{text}, expected one"
            if own is not None and ((own.to or 0.0) < 0 or (own.angle or 0.0) < 0):
                yield path, "the law of a section that twists by itself is of pressures above zero"
            if effect.slackens():
                yield (
                    path,
                    "no law is known of a section that twists by itself and has slack fabric",
                )
        if case.time is not None:
            yield "time", MOVED

    def limits_of_zones(self, case: Case) -> Iterator[Objection]:
        """What no law of one zone knows of the whole."""
        for index, effect in enumerate(case.effects):
            own = effect.inflation()
            for key in ("volume", "angle"):
                if getattr(own, key, None) is not None:
                    text = f"zones have a pressure in common and no {key}, expected to"
                    yield f"effects.{index}.{effect.name}.{key}", text

    def leaves_out(self, case: Case) -> Iterator[Objection]:
        """Fields of chosen states, which nobody asks for who wants none."""
        yield from super().leaves_out(case)
        output = case.output
        usual = type(output)()
        for name in ("field_steps", "field_halves"):
            if getattr(output, name) != getattr(usual, name):
                yield f"output.{name}", "a rod has no fields"

    def unproven(self, case: Case) -> Iterator[Objection]:
        """What docs/evidence/rod.md does not put beside a body."""
        if case.zones is not None:
            yield "zones", "no rod of zones is beside a body"
        if case.actuator.section not in _MEASURED:
            yield "actuator.section", f"a rod is beside a body with {' or '.join(_MEASURED)} alone"
        turns = case.turns
        if turns is None or turns.bulges:
            yield "effects", "a rod is beside a body with a winding in turns, or smeared, alone"
        if sum(effect.of_measured() for effect in case.effects) > 1 + _ROUNDING:
            text = "a rod is beside a body with at most 0.2 N, 50 N mm or 20 g at the tip that keep"
            yield "effects", f"{text} their directions, and under the weight of the Earth"
        if case.mesh.element != type(case.mesh)().element:
            yield "mesh.element", "elements of this kind are asked for, and a rod has none"
        if any(effect.mirror_breaker() for effect in case.acting):
            yield "effects", "out of the plane x = 0 a rod is beside a body in few scenes alone"
        load = case.inflation
        least = 0.0 if load is None else min(load.to or 0.0, load.angle or 0.0)
        rest = convert.dimensions(case.actuator).chamber_volume
        if least < 0 or (load is not None and load.volume is not None and load.volume < rest):
            yield "effects", "a rod is beside a body under pressures above zero alone"

    def completed(self, case: Case) -> Case:
        """A rod has no fields to write."""
        if "fields" in case.output.model_fields_set:
            return case
        output = case.output.model_copy(update={"fields": False})
        return case.model_copy(update={"output": output})

    def unused(self, case: Case) -> dict[str, set[str]]:
        """Mesh and solver, but for steps of loads; in motion these are steps in time."""
        loads = {"first_step", "max_step", "max_turn", "max_cutbacks"}
        steps = loads if case.time is None else set()
        return {
            "mesh": case.mesh.model_fields_set,
            "solver": case.solver.model_fields_set - steps,
        }

    def resolved_bulging(self, case: Case) -> float:
        """That of the section or the cell whose law it has."""
        turns = case.turns
        return 1.0 if turns is not None and (turns.discrete or turns.bulges) else 0.0

    def errors(self, case: Case) -> Iterator[str]:
        """Ends, and the law."""
        if case.inflation is None:
            return
        if case.straight:
            yield f"between roof and post: the sheath alone yields, {OF_STRIPS} (docs/contact.md)"
        yield (
            "law of the section: within 0.1 % of the section's own forces, or of what a warning "
            "says (fiberbend table)"
        )
        yield (
            f"{AT_ENDS}turned by the pressure as those of a short body; of the baseline, free, "
            "under its weight, 0.2 N, 50 N mm or 20 g at the tip, the angle is within 0.7 % and "
            "the tip within 1 mm of a body of 8 mm elements (docs/evidence/rod.md)"
        )
        if not all(wound(zone).plane for zone in zone_cases(case)):
            yield (
                "a section that twists by itself: free, a tube and a finger under one helix are "
                "within 1 mm of a body (docs/evidence/rod.md); across a force threads of one hand "
                "bend it to the side by shear, which a rod does not have"
            )
        if not case.straight and any(effect.touches() for effect in case.effects):
            yield (
                "obstacles: around a bar and on a table the baseline touches within 1.6 % of the "
                "pressure and presses within 1.8 % of a body (docs/evidence/rod.md)"
            )


MODEL = Rod()
