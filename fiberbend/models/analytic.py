"""`model: analytic`: the closed form of Polygerinos et al. 2015, with the case's own rubber."""

from __future__ import annotations

from collections.abc import Iterator

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.columns import MIDDLE
from fiberbend.effects.effect import ARC, CHAMBER, ENDS, HOOPS, WOUND
from fiberbend.models import lines
from fiberbend.models.model import ModelKind, Objection
from fiberbend.models.uniform import not_uniform

_LOOSE = (
    "the closed form fixes the circumference, which threads do that lie all around at 80° or more "
    "from the axis: a family of the winding does not"
)


class Analytic(ModelKind):
    """Uniform bending of a section that keeps its shape."""

    name = "analytic"
    offers = frozenset({CHAMBER, WOUND, ARC, ENDS, HOOPS})
    line = lines.ZERO_FIT
    fills = ModelKind.fills | {MIDDLE}
    agreement = 11.0
    start_s = 0.6
    pictures_s = (1.0, 0.0)

    def limits(self, case: Case) -> Iterator[Objection]:
        """No uniform bend, no fields, no closed form."""
        yield from not_uniform(case, case.turns is not None and case.turns.twists)
        if case.output.fields and "fields" in case.output.model_fields_set:
            yield "output.fields", "closed forms have no fields"
        # loads numpy: asked last
        from fiberbend.models.closed_form import SHAPE, no_analytic

        section = case.actuator.section
        if section != SHAPE:
            yield "actuator.section", f"the closed form is for a {SHAPE}, not a {section}"
            return
        turns = case.turns
        if turns is not None and not turns.tight:
            for index, effect in enumerate(case.effects):
                if effect.winds():
                    yield f"effects.{index}.{effect.name}", _LOOSE
            return
        strange = [
            (f"effects.{index}.{effect.name}", why)
            for index, effect in enumerate(case.effects)
            if (why := effect.no_closed_form())
        ]
        if strange:
            # most of them are refused by what they need, and said once
            refused = {path for path, _ in self.refused_effects(case)}
            yield from (found for found in strange if found[0] not in refused)
            return
        missing = no_analytic(case)
        if missing:
            wound = any(effect.fixes_circumference() for effect in case.effects)
            yield "materials.floor" if wound else "effects", missing

    def leaves_out(self, case: Case) -> Iterator[Objection]:
        """Details of effects, and compressibility."""
        yield from super().leaves_out(case)
        for part, material in dict(case.materials).items():
            if material is not None and convert.material(material).bulk is not None:
                text = "in closed forms every material is incompressible"
                key = "bulk" if material.young is None else "poisson"
                yield f"materials.{part}.{key}", text

    def completed(self, case: Case) -> Case:
        """A closed form has no fields to write."""
        if "fields" in case.output.model_fields_set:
            return case
        output = case.output.model_copy(update={"fields": False})
        return case.model_copy(update={"output": output})

    def unused(self, case: Case) -> dict[str, set[str]]:
        """Mesh and solver."""
        return {"mesh": case.mesh.model_fields_set, "solver": case.solver.model_fields_set}

    def force_named(self) -> str:
        """κ P over the lever."""
        return "closed form, eq. (20)"

    def force_remark(self) -> str:
        """Two errors of opposite sign."""
        return (
            "eq. (20) lies near the force of a body whose tip presses on a post, 54 beside 49 N mm "
            "on the baseline, by coincidence (docs/contact.md)"
        )

    def errors(self, case: Case) -> Iterator[str]:
        """Against the section model, and the paper's against its experiments."""
        if case.straight:
            yield "κP/L_f: 42 % below the section kept straight on the baseline (54 to 94 N mm)"
            return
        yield (
            "closed form: pressure for an angle 33 % (90°) to 13 % (360°) above the section model "
            "on the baseline (docs/crosscheck.md)"
        )
        yield "fitted to an experiment: up to 11 % in pressure (Polygerinos et al. 2015)"


MODEL = Analytic()
