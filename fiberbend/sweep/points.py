"""From a sweep file to its points: one checked case each, all problems at once."""

from __future__ import annotations

import copy
import dataclasses
import functools
import hashlib
import itertools
import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fiberbend.accuracy.words import ways_differ
from fiberbend.case.case import Case
from fiberbend.effects.straight import kept_straight
from fiberbend.models.choice import choose_model
from fiberbend.reader.base_case import BaseCase, read_base, refuse_hand
from fiberbend.reader.own_files import rooted_value
from fiberbend.reader.reader import parse_case
from fiberbend.reader.yaml_file import YamlContent, line_numbers, read_yaml
from fiberbend.schema.paths import put, value_at
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import parse, show
from fiberbend.schema.validation import from_pydantic
from fiberbend.sweep.fields import (
    VariedField,
    columns,
    labels,
    point_name,
)
from fiberbend.sweep.file import ReportSpec, SweepFile, contradictions

_REACH = "; the pressure of the base case has to reach it, effects: pressure: {to: …}"
_DESIGN = frozenset({"targets", "goals"})
"""Keys of a design file."""
_OWN_FILES = ("pictures", "fields", "report")
"""Output that a point leaves where the base case or the sweep file asks for it by name."""


@dataclasses.dataclass(frozen=True)
class Point:
    """One case of a sweep.

    Attributes:
        name: name of its run folder, made from its values.
        case: the checked case.
        blocked: the same kept straight under the pressure at which the blocked force is reported,
            or None where the force is not asked for or the model does not give it.
        given: the case as a file would give it, from which another model's case can be made.
    """

    name: str
    case: Case
    blocked: Case | None = None
    given: dict[str, Any] = dataclasses.field(default_factory=dict, compare=False, repr=False)

    @property
    def cases(self) -> tuple[Case, ...]:
        """What is solved for it."""
        return (self.case,) if self.blocked is None else (self.case, self.blocked)

    @functools.cached_property
    def digest(self) -> str:
        """Hash of the resolved cases: a result belongs to a point if it has the same."""
        content = [case.resolved() for case in self.cases]
        text = json.dumps(content, sort_keys=True, ensure_ascii=False)
        return hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclasses.dataclass(frozen=True)
class Sweep:
    """A checked sweep.

    Attributes:
        title: a line for the reader.
        points: the points in the order of the file, the last varied field fastest.
        columns: the varied fields, each with its value at every point.
        report: what is reported.
    """

    title: str
    points: tuple[Point, ...]
    columns: tuple[VariedField, ...]
    report: ReportSpec

    def part(self, chosen: Iterable[Point]) -> Sweep:
        """The same of some of its points, which stay in their order."""
        names = {point.name for point in chosen}
        kept = [index for index, point in enumerate(self.points) if point.name in names]
        varied = tuple(
            dataclasses.replace(column, values=tuple(column.values[index] for index in kept))
            for column in self.columns
        )
        points = tuple(self.points[index] for index in kept)
        return dataclasses.replace(self, points=points, columns=varied)


@dataclasses.dataclass(frozen=True)
class _Setting:
    """One changed field of a point.

    Attributes:
        path: dotted path in the case.
        value: as YAML gives it.
        origin: its place in the sweep file, `vary.actuator.radius.2`.
    """

    path: str
    value: Any
    origin: str


def read_sweep(path: Path | str, settings: Iterable[str] = ()) -> Sweep:
    """Read a sweep file and check the case of every point.

    Args:
        path: the YAML file.
        settings: changes to the base case, `actuator.floor=3 mm`, after those of the file.

    Raises:
        CaseError: everything that is wrong with the file and with its points.
    """
    path = Path(path)
    source = read_yaml(path)
    refuse_hand(source.data, path)
    if "case" not in source.data and "actuator" in source.data:
        raise CaseError([Problem(str(path), f"this is a case: fiberbend run {path}")])
    if not _DESIGN.isdisjoint(source.data):
        raise CaseError([Problem(str(path), f"this is a design: fiberbend design {path}")])
    with line_numbers(source.lines):
        return _checked(source, path, list(settings))


def _checked(source: YamlContent, path: Path, settings: Sequence[str]) -> Sweep:
    try:
        file = SweepFile.model_validate(source.data)
    except ValidationError as error:
        raise CaseError(from_pydantic(error, SweepFile)) from None
    problems = list(contradictions(file))
    if problems:
        raise CaseError(problems)
    base = read_base(file.case, file.set, source, path, settings)
    points = [_rooted(point, path.parent) for point in _settings(file)]
    checked = _check_all(base, points, file.report)
    cases = [case for case, _ in checked]
    names = labels(list(dict.fromkeys(s.path for point in points for s in point)))
    resolved = [case.resolved() for case in cases]
    found_columns = columns(names, resolved)
    result = []
    for (case, given), content in zip(checked, resolved, strict=True):
        values = {label: value_at(content, field) for field, label in names.items()}
        result.append(Point(point_name(values), case, blocked_case(case, file.report), given))
    _no_point_twice(result)
    return Sweep(file.title, tuple(result), found_columns, file.report)


def _settings(file: SweepFile) -> Iterator[tuple[_Setting, ...]]:
    """The changed fields of every point."""
    parts: list[list[list[_Setting]]] = []
    if file.points:
        parts.append(
            [
                [_Setting(path, value, f"points.{i}.{path}") for path, value in entry.items()]
                for i, entry in enumerate(file.points)
            ]
        )
    if file.zip:
        count = len(next(iter(file.zip.values())))
        parts.append(
            [
                [_Setting(path, values[i], f"zip.{path}.{i}") for path, values in file.zip.items()]
                for i in range(count)
            ]
        )
    for path, values in file.vary.items():
        parts.append([[_Setting(path, v, f"vary.{path}.{i}")] for i, v in enumerate(values)])
    for combination in itertools.product(*parts):
        yield tuple(setting for part in combination for setting in part)


def _rooted(point: tuple[_Setting, ...], folder: Path) -> tuple[_Setting, ...]:
    """The changes of a point with files of materials seen from the sweep file."""
    return tuple(
        dataclasses.replace(each, value=rooted_value(each.path, each.value, folder))
        for each in point
    )


def _check_all(
    base: BaseCase, points: list[tuple[_Setting, ...]], report: ReportSpec
) -> list[tuple[Case, dict[str, Any]]]:
    """The case of every point, checked and as it is given, or all their problems."""
    cases: list[tuple[Case, dict[str, Any]]] = []
    wrong: dict[Problem, list[int]] = {}
    for index, settings in enumerate(points):
        try:
            cases.append(_case(base.source.data, settings, report))
        except CaseError as error:
            for problem in error.problems:
                wrong.setdefault(problem, []).append(index)
    if wrong:
        raise CaseError(_merged(wrong, points, base))
    if different := ways_differ([case for case, _ in cases]):
        raise CaseError([base.reported(Problem("accuracy", different))])
    return cases


def _merged(
    wrong: dict[Problem, list[int]], points: list[tuple[_Setting, ...]], base: BaseCase
) -> Iterator[Problem]:
    """Problems of points by their cause, as few as possible.

    A problem of every point that has a value is reported once, where the value stands; one of all
    points, as one of the base case or of the report; any other by the values of its point.
    """
    with_origin: dict[str, set[int]] = {}
    for index, settings in enumerate(points):
        for setting in settings:
            with_origin.setdefault(setting.origin, set()).add(index)
    for problem, indices in wrong.items():
        left = set(indices)
        spots = {}
        for index in indices:
            for setting in points[index]:
                if f"{problem.path}.".startswith(f"{setting.path}."):
                    spots[setting.origin] = setting.origin + problem.path[len(setting.path) :]
        for origin, spot in spots.items():
            if with_origin[origin] <= set(indices):
                left -= with_origin[origin]
                yield Problem(spot, problem.text)
        if len(left) == len(points):
            yield problem if problem.path.startswith("report.") else base.reported(problem)
        else:
            for index in sorted(left):
                values = ", ".join(f"{s.path} {s.value}" for s in points[index])
                yield Problem(f"point {index + 1} ({values})", str(problem))


def _case(
    base: dict[str, Any], settings: tuple[_Setting, ...], report: ReportSpec
) -> tuple[Case, dict[str, Any]]:
    data = copy.deepcopy(base)
    problems: list[Problem] = []
    for setting in settings:
        try:
            put(data, setting.path, copy.deepcopy(setting.value))
        except CaseError as error:
            problems += (Problem(setting.path, str(problem)) for problem in error.problems)
    if problems:
        raise CaseError(problems)
    added = _request(data, report)
    try:
        case = parse_case(data)
        if report.force_at is not None and case.straight:
            # its own history has the force: no value between steps
            at = _ask(data["output"], "at_pressures", "pressure", "force_at", (report.force_at,))
            added |= dict.fromkeys(at, "report.force_at")
            case = parse_case(data)
        return case, data
    except CaseError as error:
        raise CaseError(_reported(problem, added) for problem in error.problems) from None


def _reported(problem: Problem, added: dict[str, str]) -> Problem:
    """A problem of a case at its place in the sweep file."""
    path = added.get(problem.path, problem.path)
    hint = _REACH if path.startswith("report.pressures.") else ""
    return Problem(path, problem.text + hint)


def blocked_case(case: Case, report: ReportSpec) -> Case | None:
    """A case kept straight under the pressure at which the blocked force is reported.

    Args:
        case: the case of a point.
        report: what the sweep reports.

    Returns:
        None where the force is not asked for, or the model does not give it so.

    Raises:
        CaseError: the actuator cannot be kept straight.
    """
    model = choose_model(case)[0]
    if report.force_at is None or case.straight or not model.gives_blocked_force:
        return None
    data = kept_straight(case.resolved(), show(report.force_at, "pressure"))
    data |= {"model": model.name, "output": dict.fromkeys(_OWN_FILES, False)}
    # of the bending, whose mesh this takes
    data.pop("accuracy", None)
    try:
        return parse_case(data)
    except CaseError as error:
        raise CaseError(Problem("report.force_at", str(p)) for p in error.problems) from None


def _request(data: dict[str, Any], report: ReportSpec) -> dict[str, str]:
    """Ask a case for the reported states, so that none is interpolated, and for no other files.

    Returns:
        For each place in the case that this has made, its place in the sweep file.
    """
    output = data.setdefault("output", {})
    if not isinstance(output, dict):
        return {}
    for name in _OWN_FILES:
        output.setdefault(name, False)
    angles = _ask(output, "at_angles", "angle", "angles", report.angles)
    return angles | _ask(output, "at_pressures", "pressure", "pressures", report.pressures)


def _ask(
    output: dict[str, Any], key: str, kind: str, name: str, values: tuple[float, ...]
) -> dict[str, str]:
    """Add the values of a part of the report to those that a case asks for; see `_request`."""
    given = output.setdefault(key, []) if values else None
    if not isinstance(given, list):
        return {}
    there = set()
    for text in given:
        try:
            there.add(parse(text, kind))
        except ValueError:
            continue
    added = {}
    for index, value in enumerate(values):
        if value not in there:
            added[f"output.{key}.{len(given)}"] = f"report.{name}.{index}"
            given.append(show(value, kind))
    return added


def _no_point_twice(points: list[Point]) -> None:
    first: dict[str, int] = {}
    problems = []
    for number, point in enumerate(points, start=1):
        for key in (point.digest, point.name):
            if first.setdefault(key, number) != number:
                problems.append(
                    Problem(f"point {number}", f"the same as point {first[key]}, {point.name}")
                )
                break
    if problems:
        raise CaseError(problems)
