"""From a YAML file, or a mapping, to a checked case."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, ValidationError
from pydantic.json_schema import GenerateJsonSchema

from fiberbend.case.case import (
    Actuator,
    Case,
    Materials,
    Mesh,
    Output,
    Solver,
)
from fiberbend.effects.table import EffectEntry, unwrap
from fiberbend.models import choice
from fiberbend.reader.checks import Parts, check, misfits
from fiberbend.reader.defaults import complete
from fiberbend.schema.problems import CaseError, Problem, from_pydantic

_SECTIONS: dict[str, type[BaseModel]] = {
    "actuator": Actuator,
    "materials": Materials,
    "mesh": Mesh,
    "solver": Solver,
    "output": Output,
}


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
    data = load_yaml(Path(path))
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
    return parse_case(data)


def as_case(case: Case | Mapping[str, Any] | Path | str) -> Case:
    """A case from any form of it: checked already, a mapping, or a file.

    Raises:
        CaseError: everything that is wrong with it.
    """
    if isinstance(case, Case):
        return case
    return parse_case(case) if isinstance(case, Mapping) else read_case(case)


def parse_case(data: Mapping[str, Any]) -> Case:
    """Check a case given as a mapping of plain values, as YAML holds them.

    Raises:
        CaseError: everything that is wrong with it.
    """
    problems: list[Problem] = []
    case = None
    try:
        case = Case.model_validate(data)
        parts = Parts.of(case)
    except ValidationError as error:
        problems += from_pydantic(error, Case)
        parts = _valid_parts(data) if isinstance(data, Mapping) else Parts()
    problems += check(parts)
    if problems or case is None:
        raise CaseError(problems)
    case = complete(case)
    problems += [Problem(path, text) for path, text in choice.problems(case)]
    problems += misfits(case)
    if problems:
        raise CaseError(problems)
    return case


def _valid_parts(data: Mapping[str, Any]) -> Parts:
    parts = Parts(model=str(data.get("model")))
    for name, model in _SECTIONS.items():
        try:
            setattr(parts, name, model.model_validate(data.get(name, {})))
        except ValidationError:
            continue
    entries: Any = data.get("effects")
    parts.broken_effects = not isinstance(entries, list)
    for index, entry in enumerate([] if parts.broken_effects else entries):
        try:
            parts.effects[index] = unwrap(EffectEntry.model_validate(entry))
        except ValidationError:
            parts.broken_effects = True
    return parts


class _Loader(yaml.SafeLoader):
    """Refuses a key that a mapping holds twice, where YAML would keep the last in silence."""

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        lines: dict[str, int] = {}
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                continue
            key, line = key_node.value, key_node.start_mark.line + 1
            if key in lines:
                raise yaml.MarkedYAMLError(
                    problem=f"key {key!r} a second time, expected once (line {lines[key]} has it)",
                    problem_mark=key_node.start_mark,
                )
            lines[key] = line
        return super().construct_mapping(node, deep)


def load_yaml(path: Path) -> dict[str, Any]:
    """Read a YAML file that holds one mapping.

    Raises:
        CaseError: no such file, malformed, a key twice, or no mapping.
    """
    try:
        with path.open(encoding="utf-8") as file:
            data = yaml.load(file, _Loader)
    except FileNotFoundError:
        raise CaseError([Problem(str(path), "no such file, expected a case file")]) from None
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "not text"
        raise CaseError([Problem(str(path), f"{reason}, expected a case file")]) from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        where = f"{path}, line {mark.line + 1}" if mark else str(path)
        what = getattr(error, "problem", None) or str(error).splitlines()[0]
        raise CaseError([Problem(where, f"malformed YAML, {what}")]) from None
    if not isinstance(data, dict):
        raise CaseError([Problem(str(path), "holds no mapping, expected a case")])
    return data


def root_paths(data: dict[str, Any], folder: Path) -> None:
    """Make the files that a case names independent of where it lies.

    Args:
        data: the case, not yet checked; changed in place.
        folder: that of the case file.
    """
    output = data.get("output")
    if isinstance(output, dict) and isinstance(output.get("measured"), str):
        output["measured"] = str(folder.resolve() / output["measured"])


def apply_setting(data: dict[str, Any], setting: str) -> None:
    """Change one value of a case that is not yet checked.

    Args:
        data: the case; changed in place.
        setting: a path and a YAML value, `effects.0.pressure.to=150 kPa`. It can name a key that
            the file leaves out, and the effect after the last; the schema checks what came out.

    Raises:
        CaseError: the path leads nowhere, or the value is not YAML.
    """
    path, equals, text = setting.partition("=")
    path = path.strip()
    if not equals or not path:
        raise CaseError([Problem(f"--set {setting}", 'expected a path and a value, "path=value"')])
    try:
        value = yaml.load(text, _Loader)
    except yaml.YAMLError:
        raise CaseError([Problem(path, f"{text!r} is not a YAML value")]) from None
    put(data, path, value)


def put(data: dict[str, Any], path: str, value: Any) -> None:
    """Put a value at a dotted path of a case that is not yet checked.

    Args:
        data: the case; changed in place.
        path: as in `apply_setting`.
        value: as YAML would give it.

    Raises:
        CaseError: the path leads nowhere.
    """
    keys = path.split(".")
    place: Any = data
    for depth, key in enumerate(keys):
        last = depth == len(keys) - 1
        here = ".".join(keys[: depth + 1])
        if isinstance(place, dict):
            if last:
                place[key] = value
            else:
                place = place.setdefault(key, {})
        elif isinstance(place, list):
            if not key.isdecimal() or int(key) > len(place):
                raise CaseError([Problem(here, f"no such entry, the list has {len(place)}")])
            if int(key) == len(place):
                place.append({})
            if last:
                place[int(key)] = value
            else:
                place = place[int(key)]
        else:
            parent = ".".join(keys[:depth])
            raise CaseError([Problem(here, f"no such path, {parent} is the value {place!r}")])


class _Schema(GenerateJsonSchema):
    """Writes defaults as a case would: with their unit."""

    def default_schema(self, schema: Any) -> Any:
        result = super().default_schema(schema)
        inner = schema["schema"]
        while "serialization" not in inner and isinstance(inner.get("schema"), dict):
            inner = inner["schema"]
        write = inner.get("serialization", {}).get("function")
        if write and isinstance(result.get("default"), float):
            result["default"] = write(result["default"])
        if result.get("default", 0) is None:
            del result["default"]
        return result


def json_schema() -> dict[str, Any]:
    """JSON schema of a case file, for editors that complete and check YAML."""
    schema = Case.model_json_schema(schema_generator=_Schema)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}
