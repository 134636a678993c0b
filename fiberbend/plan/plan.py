"""What a run would do, told without doing it."""

from __future__ import annotations

import dataclasses
import textwrap
from collections.abc import Iterator

from fiberbend.case.case import Case
from fiberbend.effects.table import WindingEffect
from fiberbend.models.choice import (
    MODELS,
    choose_half,
    choose_model,
    objection,
    omissions,
    refusals,
)
from fiberbend.models.mesh_size import mesh_size
from fiberbend.schema.units import show

WIDTH = 100
"""Columns of a plan."""
_INDENT = 13


@dataclasses.dataclass(frozen=True)
class Plan:
    """What a run would do.

    Attributes:
        model: name of the model.
        rows: what is said about it: a heading and one or more sentences each.
        elements: number of elements; none in a closed form.
        unknowns: displacements and pressures, before any are held.
        steps: load steps, where they can be foreseen.
    """

    model: str
    rows: tuple[tuple[str, tuple[str, ...]], ...]
    elements: int = 0
    unknowns: int = 0
    steps: int | None = None

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
    """Say what a run of a case would do; takes the mesh from the block layout, without gmsh."""
    from fiberbend.plan.error import errors_of

    model, why = choose_model(case)
    head = {
        "effects": [effect.name for effect in case.effects],
        "model": [f"{model} ({why})", *_cheaper(case, model)],
    }
    head["effects"] = [", ".join(head["effects"])]
    tail = {
        "error": list(errors_of(case, model)),
        "left out": [f"{path}: {text}" for path, text in omissions(case, model)],
        "not used": [", ".join(names)] if (names := list(unused(case, model))) else [],
    }
    remark = winding_remark(case)
    if remark is not None:
        tail["winding"] = [remark]
    if model == "analytic":
        return Plan(model, _rows(head | _closed_form(case) | tail))
    return _finite_elements(case, model, head, tail)


def _finite_elements(
    case: Case, model: str, head: dict[str, list[str]], tail: dict[str, list[str]]
) -> Plan:
    from fiberbend.plan.estimate import cost_of
    from fiberbend.plan.size import size_of

    half, why_half = choose_half(case)
    size = size_of(case, model, half)
    cost = cost_of(case, model, size)
    beside = f", and {', '.join(size.scalars)}" if size.scalars else ""
    body = {
        "half": [f"{'half' if half else 'full'} ({why_half})"],
        "elements": [f"{size.elements} {size.kind}"],
        "unknowns": [f"{size.unknowns}{beside}"],
        **cost.rows(case, model),
    }
    return Plan(model, _rows(head | body | tail), size.elements, size.unknowns, cost.steps)


def _closed_form(case: Case) -> dict[str, list[str]]:
    from fiberbend.plan.estimate import drawing_seconds, start_seconds

    time = [f"about {start_seconds('analytic'):g} s to start, a millisecond to compute"]
    drawing = drawing_seconds(case, "analytic")
    if drawing:
        time.append(f"about {drawing:g} s more for pictures")
    return {"unknowns": ["none, a closed form"], "time": time}


def _rows(rows: dict[str, list[str]]) -> tuple[tuple[str, tuple[str, ...]], ...]:
    return tuple((heading, tuple(sentences)) for heading, sentences in rows.items() if sentences)


def _cheaper(case: Case, model: str) -> Iterator[str]:
    """What each cheaper model has against the case."""
    for other in MODELS[: MODELS.index(model)]:
        against = objection(case, other)
        if against is None:
            yield f"{other} holds everything too: auto would take it"
            break
        refusal = next(refusals(case, other), None)
        path, text = refusal or against
        yield f"{other} {'cannot hold' if refusal else 'leaves out'} {path}: {text}"


def unused(case: Case, model: str) -> Iterator[str]:
    """Settings that are said and that the model has no use for.

    One case file is for several models: what another model needs is no error.
    """
    parts = {"mesh": case.mesh.model_fields_set, "solver": case.solver.model_fields_set}
    if model == "section":
        parts = {"mesh": parts["mesh"] & {"axial", "symmetry"}}
    elif model != "analytic":
        parts = {}
    for part, names in parts.items():
        yield from (f"{part}.{name}" for name in sorted(names))


def winding_remark(case: Case) -> str | None:
    """Whether the elements of a case's model resolve its winding.

    Returns:
        A sentence, or None without a discrete winding.
    """
    winding, model = case.find(WindingEffect), choose_model(case)[0]
    if winding is None or winding.representation == "smeared" or model == "analytic":
        return None
    axial, most = mesh_size(case, model, choose_half(case)[0]).axial, winding.pitch / 2
    turn = f"a pitch of {show(winding.pitch, 'length')}"
    if axial <= most * (1 + 1e-9):
        return f"resolved (elements of {show(axial, 'length')}, {turn})"
    return (
        f"NOT resolved (elements of {show(axial, 'length')} under {turn}, needs "
        f"{show(most, 'length')}): rubber between the turns bulges too little, the pressure for "
        "an angle comes out too low"
    )
