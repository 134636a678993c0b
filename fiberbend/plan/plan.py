"""What a run would do."""

from __future__ import annotations

import dataclasses
import math
import textwrap
from collections.abc import Iterator

from fiberbend.accuracy.choice import picked
from fiberbend.accuracy.words import expected_lines
from fiberbend.calibration.expected import expected
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import twists
from fiberbend.case.zones import words
from fiberbend.models.choice import MODELS, choose_model, objection
from fiberbend.models.model import MeshedModel, ModelKind, SlenderModel
from fiberbend.models.resolution import winding_remark
from fiberbend.notebook import blocks
from fiberbend.plan.doubts import doubts, errors
from fiberbend.plan.memory import shortage
from fiberbend.schema.units import show

WIDTH = 100
"""Columns of a plan."""
PAPER_SHAPE = "hemicircle"
"""The section of the paper; its figures are beside no other one."""
_INDENT = 13


@dataclasses.dataclass(frozen=True, repr=False)
class Plan:
    """What a run would do.

    Attributes:
        model: name of the model.
        rows: a heading and one or more sentences each.
        elements: number of elements; none in a closed form.
        unknowns: displacements and pressures, before any are fixed.
        steps: load steps, where they can be predicted.
        refusal: why a run would be refused here and now; empty where it would not.
        seconds: of the run with compiled kernels on one rank, without pictures; None where its
            steps cannot be predicted, or it takes the iterative solver.
        memory_mb: greatest memory on one rank, MB; None of a closed form; less than it is with the
            iterative solver.
    """

    model: str
    rows: tuple[tuple[str, tuple[str, ...]], ...]
    elements: int = 0
    unknowns: int = 0
    steps: int | None = None
    refusal: str = ""
    seconds: float | None = None
    memory_mb: float | None = None

    def __repr__(self) -> str:
        """The lines, as `fiberbend plan` prints them."""
        return "\n".join(self.lines())

    def _repr_html_(self) -> str:
        """The same as a notebook shows it."""
        pairs = [
            (heading if number == 0 else "", sentence)
            for heading, sentences in self.rows
            for number, sentence in enumerate(sentences)
        ]
        refused = [blocks.warning(f"refused: {self.refusal}")] if self.refusal else []
        return blocks.block(
            f"Plan of a run of the {self.model} model", *refused, blocks.pairs(pairs)
        )

    def lines(self) -> list[str]:
        """The plan as lines of text, none longer than `WIDTH`."""
        lines: list[str] = []
        for heading, sentences in self.rows:
            for number, sentence in enumerate(sentences):
                label = f"{heading + ':' if number == 0 else '':{_INDENT}}"
                lines += textwrap.wrap(
                    label + sentence,
                    WIDTH,
                    subsequent_indent=" " * (_INDENT + 2),
                    break_on_hyphens=False,
                )
        return lines


def make_plan(case: Case) -> Plan:
    """The plan of a case; takes the mesh from the block layout, without gmsh."""
    model, why = choose_model(case)
    beside = [] if picked(case) else _cheaper(case, model)
    head = {
        "effects": [", ".join(effect.name for effect in case.effects)],
        "zones": [f"{n}: {text}" for n, text in enumerate(words(case), start=1)],
        "model": [f"{model.name} ({why})", *beside],
    }
    actuator = convert.dimensions(case.actuator)
    tail = {
        "threads": [line for effect in case.effects for line in effect.runs(actuator)],
        "accuracy": list(expected_lines(case)),
        "error": [] if case.accuracy is not None else list(errors(case, model)),
        "left out": [f"{path}: {text}" for path, text in model.leaves_out(case)],
        "not used": [", ".join(names)] if (names := list(unused(case, model))) else [],
    }
    remark = winding_remark(case)
    if remark is not None:
        tail["winding"] = [remark]
    if found := list(expected(case)):
        tail["winding"] = found
    if found := doubts(case):
        tail["warnings"] = found
    rod = model.slender()
    if rod is not None:
        return _rod(case, rod, head, tail)
    elements = model.elements()
    if elements is None:
        return Plan(model.name, _rows(head | _closed_form(case, model) | tail))
    return _finite_elements(case, elements, head, tail)


def _finite_elements(
    case: Case, model: MeshedModel, head: dict[str, list[str]], tail: dict[str, list[str]]
) -> Plan:
    from fiberbend.plan.estimate import cost_of

    half, why_half = model.half(case)
    size = model.size(case)
    cost = cost_of(case, model, size)
    beside = f", and {', '.join(size.scalars)}" if size.scalars else ""
    about = "" if size.exact else "about "
    body = {
        "half": [f"{'half' if half else 'full'} ({why_half})"],
        "elements": [f"{about}{size.elements} {size.kind}"],
        "unknowns": [f"{about}{size.unknowns}{beside}"],
        **cost.rows(case, model),
    }
    short = shortage([cost.memory_mb], cost.free)
    return Plan(
        model.name,
        _rows(head | body | tail),
        size.elements,
        size.unknowns,
        cost.steps,
        "" if short is None else f"memory: {short}",
        None if cost.iterative else cost.seconds(),
        cost.memory_mb,
    )


def _rod(
    case: Case, model: SlenderModel, head: dict[str, list[str]], tail: dict[str, list[str]]
) -> Plan:
    from fiberbend.plan.estimate import drawing_seconds, steps_of_rod
    from fiberbend.plan.memory import gigabytes, needed_mb
    from fiberbend.slender.kept import laws_to_make

    steps, unknowns = steps_of_rod(case, model), model.unknowns(case)
    number = model.pieces + 2 * model.cap_pieces
    within = f"{model.pieces} between the caps, {model.cap_pieces} in each"
    each = f"at most {math.degrees(case.solver.max_turn or model.turn):.3g}° each"
    if case.time is not None:
        each = f"{show(case.time.step, 'time')} each, more where it touches or lifts off"
    seconds = None if steps is None else model.start_s + steps * model.step_s
    time = f"{1e3 * model.step_s:g} ms a step"
    if seconds is not None:
        time = f"about {seconds:.2g} s"
    missing, law_s = laws_to_make([case])
    law = f"about {law_s:g} s more, as the law of its section is not kept yet"
    drawing = drawing_seconds(case, model)
    memory = needed_mb(case)
    body = {
        "half": ["full (a line has no halves)"],
        "elements": [f"{number} pieces of a line: {within}"],
        "unknowns": [str(unknowns)],
        "steps": [each if steps is None else f"about {steps}, {each}"],
        "time": [f"{time}; an estimate", *([law] if missing else [])],
        "memory": [f"about {gigabytes(memory)}"],
    }
    if drawing:
        body["time"].append(f"about {drawing:.2g} s more for pictures")
    return Plan(
        model.name,
        _rows(head | body | tail),
        unknowns=unknowns,
        steps=steps,
        seconds=seconds,
        memory_mb=memory,
    )


def _closed_form(case: Case, model: ModelKind) -> dict[str, list[str]]:
    from fiberbend.plan.estimate import drawing_seconds

    time = [f"about {model.start_s:g} s to start, a millisecond to compute"]
    drawing = drawing_seconds(case, model)
    if drawing:
        time.append(f"about {drawing:g} s more for pictures")
    return {"unknowns": ["none, a closed form"], "time": time}


def _rows(rows: dict[str, list[str]]) -> tuple[tuple[str, tuple[str, ...]], ...]:
    return tuple((heading, tuple(sentences)) for heading, sentences in rows.items() if sentences)


def _cheaper(case: Case, model: ModelKind) -> Iterator[str]:
    """What each cheaper model has against the case."""
    for name, other in MODELS.items():
        if name == model.name:
            return
        against = objection(case, other)
        if against is None:
            yield f"{name} supports everything too: auto would take it"
            return
        refusal, left_out = (next(each(case), None) for each in (other.refuses, other.leaves_out))
        path, text = refusal or left_out or against
        verb = "leaves out" if left_out else "is not measured for"
        verb = "does not support" if refusal else verb
        yield f"{name} {verb} {path}: {text}"


def unused(case: Case, model: ModelKind) -> Iterator[str]:
    """Settings that the case gives and the model has no use for.

    One case file is for several models: what another model needs is no error.
    """
    for part, names in model.unused(case).items():
        yield from (f"{part}.{name}" for name in sorted(names))
    if model.elements() and case.straight and "max_turn" in case.solver.model_fields_set:
        yield "solver.max_turn"
    if model.elements() and not model.ends and case.solver.linear == "iterative":
        yield "solver.linear"
    if not model.ends and "support" in case.model_fields_set:
        yield "support"
    if case.compare and case.actuator.section != PAPER_SHAPE:
        yield "compare"
    output = case.output
    if not output.fields:
        names = {"field_steps", "field_halves"} & output.model_fields_set
        yield from (f"output.{name}" for name in sorted(names))
    elif output.field_halves == "both":
        warps = not model.ends and twists(case)
        if warps or not model.half(case)[0]:
            yield "output.field_halves"
