"""YAML files: what their values mean, what is refused, and where it stands."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend.reader.reader import read_case
from fiberbend.reader.yaml_file import YamlContent, apply_setting, read_yaml
from fiberbend.schema.paths import value_at
from fiberbend.schema.problems import CaseError

ROOT = Path(__file__).resolve().parents[2]
CASES = sorted((ROOT / "cases").rglob("*.yaml"))
BASELINE = ROOT / "cases" / "free_bending.yaml"

VALUES: list[tuple[str, Any]] = [
    # where YAML 1.2 would read text: yes to off, sexagesimal numbers, octal without an o
    ("yes", True),
    ("No", False),
    ("on", True),
    ("OFF", False),
    ("1:30", 90),
    ("12:30:45", 45045),
    ("010", 8),
    ("1_000", 1000),
    # where it would read numbers: no point, no sign in the exponent
    ("1e-3", "1e-3"),
    ("1e+3", "1e+3"),
    ("1.5e3", "1.5e3"),
    ("-.5", "-.5"),
    ("0o10", "0o10"),
    # where some readers of 1.1 would read yes and no
    ("y", "y"),
    ("n", "n"),
    # the same in both
    ("true", True),
    ("~", None),
    ("1.0e-3", 1e-3),
    (".inf", math.inf),
    ("0x1F", 31),
    ("8 mm", "8 mm"),
    ("1e-3 mm", "1e-3 mm"),
    ("'yes'", "yes"),
]


def source(text: str, folder: Path) -> YamlContent:
    path = folder / "case.yaml"
    path.write_text(text, encoding="utf-8")
    return read_yaml(path)


@pytest.mark.parametrize(("text", "value"), VALUES)
def test_values_are_those_of_yaml_1_1(text: str, value: Any, tmp_path: Path) -> None:
    read = source(f"a: {text}\n", tmp_path).data["a"]
    data: dict[str, Any] = {}
    apply_setting(data, f"a={text}")
    for found in (read, data["a"]):
        assert (type(found), found) == (type(value), value)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_every_value_has_its_line(path: Path) -> None:
    read = read_yaml(path)
    assert read.data == yaml.safe_load(path.read_text(encoding="utf-8"))
    text = path.read_text(encoding="utf-8").splitlines()
    for place, line in read.lines.items():
        key = place.rpartition(".")[2]
        assert (
            key.isdecimal()
            or key in text[line - 1]
            or place.rpartition("vary.")[2] in text[line - 1]
        )
    for key in read.data:
        assert text[read.lines[key] - 1].startswith(key)


def test_anchors_merges_and_lists(tmp_path: Path) -> None:
    text = """\
base: &base {wall: 2 mm,
  radius: 8 mm}
actuator:
  <<: *base
  radius: 9 mm
list:
- 1
- - 2
  - c: 3
"""
    read = source(text, tmp_path)
    assert read.data["actuator"] == {"wall": "2 mm", "radius": "9 mm"}
    expected = {"base.radius": 2, "actuator.radius": 5, "list.0": 7, "list.1.1.c": 9}
    assert {place: read.lines[place] for place in expected} == expected
    assert value_at(read.data, "list.1.1.c") == 3


def test_a_value_within_itself_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"line 1: malformed YAML, a value within itself"):
        source("actuator: &me {radius: *me}\n", tmp_path)
    with pytest.raises(CaseError, match="is not a YAML value"):
        apply_setting({}, "actuator=&me {radius: *me}")


def complaint(tmp_path: Path, old: str, new: str, *settings: str) -> list[str]:
    text = BASELINE.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "case.yaml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    with pytest.raises(CaseError) as error:
        read_case(path, settings)
    return str(error.value).splitlines()


def line_of(word: str) -> int:
    lines = BASELINE.read_text(encoding="utf-8").splitlines()
    return next(number for number, line in enumerate(lines, start=1) if word in line)


def test_a_problem_names_its_line(tmp_path: Path) -> None:
    (line,) = complaint(tmp_path, "radius: 8 mm", "radius: 8")
    assert line.startswith("actuator.radius: 8, expected a length")
    assert line.endswith(f" (line {line_of('radius:')})")


def test_what_is_missing_names_the_line_of_its_part(tmp_path: Path) -> None:
    (line,) = complaint(tmp_path, "pitch: 3 mm, ", "")
    assert line.startswith("effects.1.winding.pitch: missing")
    assert line.endswith(f" (line {line_of('winding:')})")
    lines = complaint(tmp_path, "actuator:", "actuators:")
    assert "actuator: missing, expected dimensions" in lines


def test_what_comes_from_elsewhere_names_no_line(tmp_path: Path) -> None:
    lines = complaint(tmp_path, "radius: 8 mm", "radius: 8", "actuator.wall=3", "effects.1.x=3")
    assert [line.endswith(")") for line in lines if line.startswith("actuator.radius")] == [True]
    assert not any(line.endswith(")") for line in lines if not line.startswith("actuator.radius"))


def test_numbers_that_yaml_takes_for_text_are_explained(tmp_path: Path) -> None:
    (line,) = complaint(tmp_path, "model:", "solver: {tolerance: 1e-9}\nmodel:")
    assert line.startswith('solver.tolerance: "1e-9", expected a number; YAML wants a point')
    (line,) = complaint(tmp_path, "model:", "solver: {tolerance: small}\nmodel:")
    assert line.startswith('solver.tolerance: "small", expected a number (line ')
