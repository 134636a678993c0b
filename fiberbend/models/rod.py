"""`model: rod`: the actuator as a line, by the law of its section and of its caps."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry
from fiberbend.columns import MIDDLE, OBSTACLES, SOLVED, TIMED
from fiberbend.effects.effect import CHAMBER, ENDS, SIDE, THREAD, TURNS, TWIST, WOUND
from fiberbend.effects.records import LINE, MOTION
from fiberbend.models.ends import AT_ENDS
from fiberbend.models.model import ModelKind, Objection, SlenderModel

_SECTION_S, _CELL_S = 8.0, 15.0
"""Seconds for the table of a section and of a cell, of the baseline (`fiberbend table`)."""


class Rod(SlenderModel):
    """A geometrically exact rod: a uniform bend anew in every piece, under weights and loads."""

    name = "rod"
    offers = frozenset({CHAMBER, WOUND, THREAD, TURNS, TWIST, SIDE, LINE, ENDS, MOTION})
    fills = ModelKind.fills | {MIDDLE, SOLVED, OBSTACLES, TIMED}
    ends = True
    agreement = 0.5
    start_s = 4.0
    pictures_s = (5.0, 1.0)
    turn = math.radians(10)
    pieces, cap_pieces = 48, 4
    step_s = 0.02

    def unknowns(self, case: Case) -> int:
        """A stretch and a curvature each."""
        return 2 * (self.pieces + 2 * self.cap_pieces)

    def law_seconds(self, case: Case) -> float:
        """Of a cell more than of a section."""
        turns = case.turns
        return _CELL_S if turns is not None and turns.discrete else _SECTION_S

    def limits(self, case: Case) -> Iterator[Objection]:
        """No law of its section reaches there."""
        load = case.inflation
        if load is None:
            text = "the law of a section reaches from rest to a pressure or an angle"
            yield "effects", f"{text}, expected effect pressure with one"
        for index, effect in enumerate(case.effects):
            path, own = f"effects.{index}.{effect.name}", effect.inflation()
            if own is not None and own.volume is not None:
                text = "the law of a section reaches to a pressure or an angle, expected one"
                yield f"{path}.volume", text
            if own is not None and ((own.to or 0.0) < 0 or (own.angle or 0.0) < 0):
                yield path, "the law of a section is of pressures above zero, and no vacuum"
        known = [effect for effect in case.acting if self.offers.issuperset(effect.needs())]
        wound, symmetry = self._wound(case), Symmetry.of(known)
        if not wound.plane:
            yield "effects", f"the law of its section is of stretch and curvature: {wound.words()}"
        elif symmetry.across:
            reasons = "; ".join(symmetry.across)
            yield "effects", f"the law of its section is of bending in the plane x = 0: {reasons}"
        if case.output.fields and "fields" in case.output.model_fields_set:
            yield "output.fields", "a rod has no fields: its sections are known by their law alone"

    def _wound(self, case: Case) -> Symmetry:
        """Symmetry of its section."""
        beside = (effect.beside() for effect in case.effects)
        return Symmetry.of([effect for effect in beside if effect is not None])

    def leaves_out(self, case: Case) -> Iterator[Objection]:
        """How sections near the caps differ from others."""
        yield from super().leaves_out(case)
        yield (
            "actuator.cap",
            "shear forces bend the chamber's ends as all of it, and caps are beams",
        )

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
        yield "law of the section: within 0.1 % of the section's own forces (fiberbend table)"
        yield (
            f"{AT_ENDS}a short body says how a pressure turns them; angle and tip of the baseline "
            "are within 0.7 % and 1 mm of a body's of 8 mm elements (docs/evidence/rod.md)"
        )


MODEL = Rod()
