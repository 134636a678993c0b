"""The names that a case may use are those of the tables: no table is copied by hand."""

from __future__ import annotations

import dataclasses
import typing

import pytest

from fiberbend.case import names
from fiberbend.case.case import ActuatorSpec, Case, MaterialSpec
from fiberbend.effects.winding import WindingEffect
from fiberbend.models.analytic import Analytic
from fiberbend.models.choice import MODELS
from fiberbend.reader.reader import read_case
from fiberbend.running.analytic import run_analytic
from fiberbend.running.progress import Progress
from fiberbend.schema.quantities import Spec
from geometry.sections.table import SECTIONS
from geometry.winding.patterns import PATTERNS
from materials.laws.table import LAWS
from tests.conftest import ROOT


def said(part: type[Spec], key: str) -> set[str]:
    """The words that a key takes."""
    annotation = part.model_fields[key].annotation
    choices = [annotation, *typing.get_args(annotation)]
    return {
        word
        for choice in choices
        if typing.get_origin(choice) is typing.Literal
        for word in typing.get_args(choice)
    }


@pytest.mark.parametrize(
    ("part", "key", "words"),
    [
        (ActuatorSpec, "section", set(SECTIONS)),
        (MaterialSpec, "law", set(LAWS)),
        (WindingEffect, "pattern", set(PATTERNS)),
        (Case, "model", {*MODELS, "auto"}),
    ],
)
def test_a_case_names_what_there_is(part: type[Spec], key: str, words: set[str]) -> None:
    assert said(part, key) == words


def test_dimensions_are_those_that_some_section_has() -> None:
    fields = {field.name for shape in SECTIONS.values() for field in dataclasses.fields(shape)}
    assert set(ActuatorSpec.model_fields) == {"section", *fields}


def test_every_model_is_found_by_its_own_name() -> None:
    assert [model.name for model in MODELS.values()] == list(names.MODELS)


def test_no_model_is_solved_by_another_ones_closed_form(monkeypatch: pytest.MonkeyPatch) -> None:
    class Silent(Analytic):
        """Says neither elements nor a line."""

        line = ""

    monkeypatch.setitem(MODELS, "analytic", Silent())
    case = read_case(ROOT / "cases" / "free_bending_smeared.yaml", ["model=analytic"])
    with pytest.raises(NotImplementedError, match="has neither elements nor a closed form"):
        run_analytic(case, None, Progress(quiet=True))
