"""From a design file to what is searched, all problems at once."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fiberbend.case.case import Case
from fiberbend.design.fields import Fields, Pairs, read_fields
from fiberbend.design.file import DesignFile, Goal, Search, problems
from fiberbend.design.quantities.quantity import Quantity
from fiberbend.reader.base_case import read_base, refuse_hand
from fiberbend.reader.own_files import rooted_values
from fiberbend.reader.reader import parse_case
from fiberbend.reader.yaml_file import YamlContent, line_numbers, read_yaml, setting_path
from fiberbend.schema.paths import put, value_at
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import KINDS, parse
from fiberbend.schema.validation import from_pydantic

_MADE = ("actuator", "materials", "effects", "zones")
"""Parts of a case that are made of something."""
_IDLE = "no effect: targets and goals say at which pressure or angle"


@dataclasses.dataclass(frozen=True)
class Design:
    """A checked design.

    Attributes:
        title: a line for the reader.
        data: the base case as a file has it.
        base: the same, checked.
        fields: what may change.
        targets: what is wanted.
        goals: what is best among cases that have it.
        search: how it searches.
        confirm: models in which the answer is confirmed.
    """

    title: str
    data: dict[str, Any]
    base: Case
    fields: Fields
    targets: tuple[Quantity[Any], ...]
    goals: tuple[Goal, ...]
    search: Search
    confirm: str

    @property
    def quantities(self) -> tuple[Quantity[Any], ...]:
        """All that is computed: what is wanted, then what is best."""
        return (*self.targets, *(goal.quantity for goal in self.goals))

    def changed(self, values: Iterable[tuple[str, Any]]) -> dict[str, Any]:
        """The base case with other values, as a file would have it.

        Raises:
            CaseError: there is no such path.
        """
        data = copy.deepcopy(self.data)
        for path, value in values:
            put(data, path, copy.deepcopy(value))
        return data


def read_design(path: Path | str, settings: Iterable[str] = ()) -> Design:
    """Read a design file, and check its base case and the ends of all fields.

    Args:
        path: the YAML file.
        settings: changes to the base case, `actuator.floor=3 mm`, after those of the file.

    Raises:
        CaseError: everything that is wrong with it.
    """
    path = Path(path)
    source = read_yaml(path)
    refuse_hand(source.data, path)
    if "case" not in source.data and "actuator" in source.data:
        raise CaseError([Problem(str(path), f"this is a case: fiberbend run {path}")])
    wanted = {"targets", "goals"} & source.data.keys()
    if not wanted and {"vary", "zip", "points"} & source.data.keys():
        raise CaseError([Problem(str(path), f"this is a sweep: fiberbend sweep {path}")])
    with line_numbers(source.lines):
        return _checked(source, path, list(settings))


def _checked(source: YamlContent, path: Path, settings: Sequence[str]) -> Design:
    try:
        file = DesignFile.model_validate(source.data)
    except ValidationError as error:
        raise CaseError(from_pydantic(error, DesignFile)) from None
    wrong = list(problems(file))
    fields = Fields((), ())
    try:
        # files of materials among the choices are seen from this file
        vary = {field: rooted_values(field, v, path.parent) for field, v in file.vary.items()}
        fields = read_fields(vary)
    except CaseError as error:
        wrong += error.problems
    if wrong:
        raise CaseError(wrong)
    base_case = read_base(file.case, file.set, source, path, settings)
    data = base_case.source.data
    try:
        base = parse_case(data)
    except CaseError as error:
        raise CaseError(base_case.reported(p) for p in error.problems) from None
    design = Design(
        file.title,
        data,
        base,
        fields,
        file.targets,
        file.goals,
        file.search,
        file.confirm,
    )
    changes = [(f"set.{field}", field) for field in file.set]
    changes += [(f"--set {setting}", setting_path(setting)) for setting in settings]
    idle = (where for where, field in changes if _of_pressure(base, field))
    wrong = [Problem(where, _IDLE) for where in idle]
    wrong += [*_not_of_case(design), *_at_ends(design)]
    if wrong:
        raise CaseError(wrong)
    return design


def _not_of_case(design: Design) -> Iterator[Problem]:
    """Quantities that the base case does not have, and loads that nothing here gives."""
    case = design.base
    if case.inflation is None:
        yield Problem("case", "no effect pressure, expected one: its value is chosen here")
    for index, effect in enumerate(case.effects):
        if effect.keeps_straight():
            text = (
                "keeps it straight, expected free bending: blocked-force keeps it straight itself"
            )
            yield Problem(f"case: effects.{index}.{effect.name}", text)
        elif acts := effect.alone():
            text = f"{acts}, which the section that is searched does not know"
            yield Problem(f"case: effects.{index}.{effect.name}", text)
    yield from _idle(design)
    for index, target in enumerate(design.targets):
        yield from target.wrong(f"targets.{index}.{target.name}", case)
    for index, goal in enumerate(design.goals):
        key = "minimise" if goal.sign > 0 else "maximise"
        yield from goal.quantity.wrong(f"goals.{index}.{key}.{goal.quantity.name}", case)


def _idle(design: Design) -> Iterator[Problem]:
    """Fields that vary and say nothing of what an actuator is."""
    paths = [each.path for each in design.fields.varied]
    paths += [each.path for each in design.fields.choices]
    for path in paths:
        if path.split(".")[0] not in _MADE:
            text = f"says nothing of the actuator, expected a field of {', '.join(_MADE)}"
            yield Problem(f"vary.{path}", text)
        if _of_pressure(design.base, path):
            yield Problem(f"vary.{path}", _IDLE)


def _of_pressure(case: Case, path: str) -> bool:
    """Whether a path leads into the pressure of a case, whose value a design chooses."""
    return any(
        effect.inflation() is not None and path.startswith(f"effects.{index}.")
        for index, effect in enumerate(case.effects)
    )


def _at_ends(design: Design) -> Iterator[Problem]:
    """What the schema says of the ends of every field and of every choice.

    Each is put into the base case alone: values that do not fit each other are the search's.
    """
    for field in design.fields.varied:
        for key, value in (("from", field.low), ("to", field.high)):
            values = ((field.path, field.text(value)),)
            yield from _alone(design, values, f"{field.path}.{key}", whole=False)
    for choice in design.fields.choices:
        for key, value in choice.origins().items():
            values = ((choice.path, value),)
            yield from _alone(design, values, f"{choice.path}.{key}", whole=True)


def _alone(design: Design, values: Pairs, origin: str, whole: bool) -> Iterator[Problem]:
    """What is wrong with one value in the base case.

    Args:
        design: the design.
        values: the value with its path.
        origin: its place under `vary`.
        whole: what the case says of the value itself counts too, as the name of a material.
    """
    ((path, _),) = values
    try:
        data = design.changed(values)
    except CaseError as error:
        yield from (Problem(f"vary.{origin}", f"{p.path}: {p.text}") for p in error.problems)
        return
    try:
        Case.model_validate(data)
    except ValidationError as error:
        for problem in from_pydantic(error, Case):
            # pydantic names the part that has no such key
            if f"{problem.path}.".startswith(f"{path}."):
                yield Problem(f"vary.{origin}{problem.path.removeprefix(path)}", problem.text)
            elif f"{path}.".startswith(f"{problem.path}."):
                yield Problem(f"vary.{origin}", f"{problem.path}: {problem.text}")
        return
    if not whole:
        return
    try:
        parse_case(data)
    except CaseError as error:
        for problem in error.problems:
            if f"{problem.path}.".startswith(f"{path}."):
                yield Problem(f"vary.{origin}{problem.path.removeprefix(path)}", problem.text)


def own_numbers(design: Design) -> list[float | None]:
    """Values of the varied numbers in the base case, in internal units; None: it has none."""
    resolved = design.base.resolved()
    return [_number(value_at(resolved, field.path), field.unit) for field in design.fields.varied]


def _number(value: object, unit: str) -> float | None:
    if isinstance(value, int | float) and not isinstance(value, bool) and not unit:
        return float(value)
    if isinstance(value, str) and unit:
        for kind in KINDS:
            try:
                parse(f"1 {unit}", kind)
                return parse(value, kind)
            except ValueError:
                continue
    return None
