"""From a YAML file, or a mapping, to a checked case."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from fiberbend.case.case import (
    ActuatorSpec,
    Case,
    Materials,
    Mesh,
    Output,
    Solver,
)
from fiberbend.effects.table import EffectEntry, unwrap
from fiberbend.models import choice
from fiberbend.reader.checks import ValidParts, check, mesh_problems
from fiberbend.reader.defaults import complete
from fiberbend.reader.yaml_file import (
    apply_setting,
    line_numbers,
    read_yaml,
    root_paths,
    setting_path,
)
from fiberbend.schema.problems import CaseError, Problem, found
from fiberbend.schema.validation import from_pydantic

_PARTS: dict[str, type[BaseModel]] = {
    "actuator": ActuatorSpec,
    "materials": Materials,
    "mesh": Mesh,
    "solver": Solver,
    "output": Output,
}

_SWEEP = frozenset({"vary", "zip", "points"})
"""Keys by which a file with a key `case` is a sweep's."""


def read_case(path: Path | str, settings: Iterable[str] = ()) -> Case:
    """Read a case file.

    Args:
        path: the YAML file.
        settings: changes to it, `effects.0.pressure.to=150 kPa`, any path of the case. A file that
            the case file names is relative to it, one in a setting to the working folder.

    Returns:
        The checked case.

    Raises:
        CaseError: everything that is wrong with file, settings and case.
    """
    source, settings = read_yaml(Path(path)), list(settings)
    data = source.data
    if "case" in data and not _SWEEP.isdisjoint(data):
        raise CaseError([Problem(str(path), f"this is a sweep: fiberbend sweep {path}")])
    root_paths(data, Path(path).parent)
    problems: list[Problem] = []
    for setting in settings:
        try:
            apply_setting(data, setting)
        except CaseError as error:
            problems += error.problems
    if problems:
        raise CaseError(problems)
    root_paths(data, Path())
    with line_numbers(source.lines, [setting_path(setting) for setting in settings]):
        return parse_case(data)


def as_case(case: Case | Mapping[str, Any] | Path | str) -> Case:
    """A case from any form of it: checked already, a mapping, or a file.

    Raises:
        CaseError: everything that is wrong with it.
    """
    if isinstance(case, Case):
        return case
    if isinstance(case, Mapping):
        return parse_case(dict(case))
    if isinstance(case, (str, Path)):
        return read_case(case)
    wanted = "expected a Case, a mapping or the path of a case file"
    raise CaseError([Problem("case", f"{found(case)}, {wanted}")])


def parse_case(data: Mapping[str, Any]) -> Case:
    """Check a case given as a mapping of plain values, as YAML gives them.

    Raises:
        CaseError: everything that is wrong with it.
    """
    problems: list[Problem] = []
    case = None
    try:
        case = Case.model_validate(data)
        parts = ValidParts.of(case)
    except ValidationError as error:
        problems += from_pydantic(error, Case)
        parts = _valid_parts(data) if isinstance(data, Mapping) else ValidParts()
    problems += check(parts)
    if problems or case is None:
        raise CaseError(problems)
    case = complete(case)
    problems += [Problem(path, text) for path, text in choice.problems(case)]
    problems += mesh_problems(case)
    if problems:
        raise CaseError(problems)
    return case


def _valid_parts(data: Mapping[str, Any]) -> ValidParts:
    valid: dict[str, Any] = {}
    for name, part in _PARTS.items():
        try:
            valid[name] = part.model_validate(data.get(name, {}))
        except ValidationError:
            continue
    entries: Any = data.get("effects")
    broken, effects = not isinstance(entries, list), {}
    for index, entry in enumerate([] if broken else entries):
        try:
            effects[index] = unwrap(EffectEntry.model_validate(entry))
        except ValidationError:
            broken = True
    return ValidParts(model=str(data.get("model")), effects=effects, broken_effects=broken, **valid)
