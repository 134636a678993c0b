"""Write docs/case_file.md from the schema, and docs/commands.md from the commands' help."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from bench import materials_page
from bench.rod import page as rod_page
from fiberbend.reader.json_schema import json_schema
from fiberbend.schema.units import KINDS

ROOT = Path(__file__).resolve().parent.parent
WIDTH = 96
"""Columns of a help text."""

CASE_HEAD = """# The case file

<!-- Written by `make docs` from the schema of a case; do not edit by hand. -->

A case is a YAML file. It describes one actuator and what acts on it. Every physical value carries
its unit, for example `8 mm` or `200 kPa`. The program refuses a bare number where a unit belongs,
an unknown key and a setting that would have no effect. The message gives the path of the value,
for example `actuator.wall`. The same paths work on the command line with `--set`.

An editor checks the file while you type if its first line names the schema:

```yaml
# yaml-language-server: $schema=case.schema.json
```

The file `cases/case.schema.json` is this schema; `fiberbend schema` prints it.
[Models, and when to trust each](models.md) says which model supports which effect, and
[Materials](materials.md) lists the materials that have names, with their sources.

"""
COMMANDS_HEAD = """# The commands

<!-- Written by `make docs` from the help of the commands; do not edit by hand. -->

`fiberbend COMMAND --help` prints the same texts. Exit codes are explained in
[When it fails](when_it_fails.md).

"""


def _kind(example: str) -> str:
    """What a quantity with such an example is."""
    names = [kind.name for kind in KINDS.values() if kind.example == example]
    return names[0].split(" ", 1)[1] if names else "quantity"


def _cell(text: Any) -> str:
    return " ".join(str(text).split()).replace("|", "\\|")


def _value(schema: Mapping[str, Any]) -> str:
    """What a key takes, in words."""
    if "$ref" in schema:
        return _anchor(schema["$ref"])
    if "anyOf" in schema:
        known = [_value(part) for part in schema["anyOf"] if part.get("type") != "null"]
        return " or ".join(dict.fromkeys(known))
    if "enum" in schema:
        return ", ".join(f"`{value}`" for value in schema["enum"])
    if "const" in schema:
        return f"`{schema['const']}`"
    kind = schema["type"]
    if kind == "array":
        if "prefixItems" in schema:
            parts = [_value(part) for part in schema["prefixItems"]]
            return f"list of {len(parts)}: {parts[0]}"
        return f"list: {_value(schema['items'])}"
    if kind == "string" and schema.get("examples"):
        example = schema["examples"][0]
        return f"{_kind(example)}, such as `{example}`"
    if kind in ("integer", "number"):
        name = {"integer": "whole number", "number": "number"}[kind]
        low, high = schema.get("minimum"), schema.get("maximum")
        if schema.get("exclusiveMinimum") == 0:
            name += " above zero"
        if low is not None and high is not None:
            return f"{name}, {low:g} to {high:g}"
        return name + (f", at least {low:g}" if low is not None else "")
    return {"boolean": "`true` or `false`", "string": "text", "object": "mapping"}[kind]


def _anchor(reference: str) -> str:
    name = reference.rsplit("/", 1)[-1]
    return f"see [{TITLES[name]}](#{_slug(TITLES[name])})"


def _slug(title: str) -> str:
    """The anchor of a heading, as both GitHub and MyST make it."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


TITLES: dict[str, str] = {}
"""Headings of the parts of a case, by the names of the schema."""


def _name_parts(schema: Mapping[str, Any]) -> None:
    """Name the schema's parts as a case writes them."""
    parts = schema["$defs"]

    def follow(properties: Mapping[str, Any], before: str) -> None:
        for key, value in properties.items():
            ways = [value, *value.get("anyOf", ())]
            inner = [*ways, *(way.get("items", {}) for way in ways)]
            for reference in (each["$ref"] for each in inner if "$ref" in each):
                name = reference.rsplit("/", 1)[-1]
                if name in TITLES:
                    continue
                path = f"{before}{key}"
                TITLES[name] = f"`{path}`"
                part = _object(parts[name])
                # an effect has its name for its path
                follow(part.get("properties", {}), "" if name == "EffectEntry" else f"{path}.")

    follow(schema["properties"], "")
    TITLES["MaterialSpec"] = "A material"
    TITLES["FiberSpec"] = "A fiber"
    for key, reference in parts["EffectEntry"]["properties"].items():
        TITLES[reference["$ref"].rsplit("/", 1)[-1]] = f"Effect `{key}`"


def _object(part: Mapping[str, Any]) -> Mapping[str, Any]:
    """The mapping among the ways to write a part."""
    return next((way for way in part.get("anyOf", ()) if way["type"] == "object"), part)


def _rows(part: Mapping[str, Any]) -> Iterator[str]:
    needed = set(part.get("required", ()))
    yield "| key | value | default | meaning |"
    yield "|---|---|---|---|"
    for key, value in part["properties"].items():
        default = value.get("default")
        if key in needed:
            shown = "**required**"
        elif default is None or isinstance(default, dict) or default in ("", []):
            shown = "–"
        else:
            shown = f"`{json.dumps(default) if not isinstance(default, str) else default}`"
        meaning = _cell(value.get("description", ""))
        yield f"| `{key}` | {_cell(_value(value))} | {shown} | {meaning} |"


def case_file() -> str:
    """The page of the case file."""
    schema = json_schema()
    _name_parts(schema)
    lines = [CASE_HEAD.rstrip(), "", "## Keys of a case", "", *_rows(schema), ""]
    for name, title in TITLES.items():
        part = _object(schema["$defs"][name])
        lines += [f"## {title}", "", _cell(part["description"]), ""]
        if part.get("properties"):
            lines += [*_rows(part), ""]
        else:
            lines += ["It takes no settings.", ""]
    return "\n".join(lines).rstrip() + "\n"


def commands() -> str:
    """The page of the commands."""
    from rich.console import Console

    from fiberbend.cli import app

    lines = [COMMANDS_HEAD.rstrip(), ""]
    for name in app:
        if name.startswith("-"):
            continue
        file = io.StringIO()
        console = Console(file=file, width=WIDTH, force_terminal=False, color_system=None)
        app.help_print([name], console=console)
        text = "\n".join(line.rstrip() for line in file.getvalue().strip().splitlines())
        lines += [f"## fiberbend {name}", "", "```text", text, "```", ""]
    return "\n".join(lines).rstrip() + "\n"


PAGES: dict[str, Callable[[], str]] = {
    "docs/case_file.md": case_file,
    "docs/commands.md": commands,
    "docs/materials.md": materials_page.page,
    "docs/evidence/rod.md": rod_page.page,
}
"""Pages by their path, each with what writes it."""

if __name__ == "__main__":
    for page, text in PAGES.items():
        (ROOT / page).write_text(text(), encoding="utf-8")
