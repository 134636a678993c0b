"""YAML files, and changes to what is in them before it is checked."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from fiberbend.schema.paths import put
from fiberbend.schema.problems import CaseError, Problem


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
