"""From a YAML file, or a mapping, to a checked case."""

from __future__ import annotations

import contextlib
import copy
from collections.abc import Iterable, Iterator, Mapping
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
from fiberbend.case.timed.spec import TimeSpec
from fiberbend.effects.table import EffectEntry, unwrap
from fiberbend.models import choice
from fiberbend.reader.base_case import refuse_hand
from fiberbend.reader.checks import ValidParts, check, mesh_problems
from fiberbend.reader.defaults import complete
from fiberbend.reader.own_files import inlined, root_paths
from fiberbend.reader.yaml_file import (
    apply_setting,
    line_numbers,
    read_yaml,
    setting_path,
)
from fiberbend.reader.zones import zone_problems
from fiberbend.schema.paths import put
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
_DESIGN = frozenset({"targets", "goals"})
"""Keys by which it is a design's."""


def read_case(path: Path | str, settings: Iterable[str] | Mapping[str, Any] = ()) -> Case:
    """Read a case file.

    Args:
        path: the YAML file.
        settings: changes to it, `effects.0.pressure.to=150 kPa` each, or values by their dotted
            paths; any path of the case. A file that the case file names is relative to it, one in
            a setting to the working folder.

    Returns:
        The checked case.

    Raises:
        CaseError: everything that is wrong with file, settings and case.
    """
    source = read_yaml(Path(path))
    settings = settings if isinstance(settings, Mapping) else list(settings)
    data = source.data
    refuse_hand(data, path)
    if "case" in data and not _DESIGN.isdisjoint(data):
        raise CaseError([Problem(str(path), f"this is a design: fiberbend design {path}")])
    if "case" in data and not _SWEEP.isdisjoint(data):
        raise CaseError([Problem(str(path), f"this is a sweep: fiberbend sweep {path}")])
    root_paths(data, Path(path).parent)
    _change(data, settings)
    root_paths(data, Path())
    with line_numbers(source.lines, [setting_path(setting) for setting in settings]):
        return parse_case(data)


def as_case(
    case: Case | Mapping[str, Any] | Path | str,
    settings: Iterable[str] | Mapping[str, Any] = (),
) -> Case:
    """A case from any form of it: checked already, a mapping, or a file.

    Args:
        case: the case; of one that is checked already, every default is a given value. Files that
            a mapping names are relative to the working folder.
        settings: changes to it, `actuator.wall=3 mm` each, or values by their dotted paths.

    Raises:
        CaseError: everything that is wrong with it.
    """
    if isinstance(settings, str):
        text = f"{found(settings)}, expected a list of path=value, or a mapping"
        raise CaseError([Problem("settings", text)])
    if isinstance(case, Case):
        if not settings:
            return case
        case = case.resolved()
    if isinstance(case, Mapping):
        data = copy.deepcopy(dict(case))
        _change(data, settings)
        root_paths(data, Path())
        return parse_case(data)
    if isinstance(case, (str, Path)):
        return read_case(case, settings)
    wanted = "expected a Case, a mapping or the path of a case file"
    raise CaseError([Problem("case", f"{found(case)}, {wanted}")])


def _change(data: dict[str, Any], settings: Iterable[str] | Mapping[str, Any]) -> None:
    """Change values of a case that is not yet checked, or say all that is wrong with the paths."""
    settings = settings if isinstance(settings, Mapping) else list(settings)
    problems: list[Problem] = list(_lost(settings))
    pairs = settings.items() if isinstance(settings, Mapping) else [(s, None) for s in settings]
    for setting, value in pairs:
        try:
            if not isinstance(setting, str):
                raise CaseError([Problem("settings", f"{found(setting)}, expected a dotted path")])
            if isinstance(settings, Mapping):
                put(data, setting, copy.deepcopy(value))
            else:
                apply_setting(data, setting)
        except CaseError as error:
            problems += error.problems
    if problems:
        raise CaseError(problems)


def _lost(settings: Iterable[Any]) -> Iterator[Problem]:
    """Changes within a part that a later one replaces as a whole: nothing would be left of them."""
    paths = [setting_path(setting) for setting in settings if isinstance(setting, str)]
    for number, path in enumerate(paths):
        for later in paths[number + 1 :]:
            if path.startswith(f"{later}."):
                yield Problem(path, f"no effect: {later} is set after it, expected it before")
                break


def parse_case(data: Mapping[str, Any]) -> Case:
    """Check a case given as a mapping of plain values, as YAML gives them.

    Raises:
        CaseError: everything that is wrong with it.
    """
    own = inlined(data) if isinstance(data, Mapping) else None
    if own is None or not own.files:
        return _checked(data if own is None else own.data)
    try:
        return _checked(own.data)
    except CaseError as error:
        raise CaseError(own.located(problem) for problem in error.problems) from None


def _checked(data: Mapping[str, Any]) -> Case:
    """A case of a mapping that names no file of a material."""
    problems: list[Problem] = []
    case = None
    try:
        case = Case.model_validate(data)
        parts = ValidParts.of(case)
    except ValidationError as error:
        problems += from_pydantic(error, Case)
        parts = _valid_parts(data) if isinstance(data, Mapping) else ValidParts()
    problems += check(parts)
    if case is not None and case.zones is not None:
        problems += zone_problems(case, problems)
    if problems or case is None:
        raise CaseError(problems)
    if case.accuracy is not None:
        from fiberbend.accuracy import choice as accuracy

        problems += [Problem(path, text) for path, text in accuracy.problems(case)]
    if problems:
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
    if data.get("time") is not None:
        with contextlib.suppress(ValidationError):
            valid["time"] = TimeSpec.model_validate(data["time"])
    entries: Any = data.get("effects")
    broken, effects = not isinstance(entries, list), {}
    for index, entry in enumerate([] if broken else entries):
        try:
            effects[index] = unwrap(EffectEntry.model_validate(entry))
        except ValidationError:
            broken = True
    return ValidParts(model=str(data.get("model")), effects=effects, broken_effects=broken, **valid)
