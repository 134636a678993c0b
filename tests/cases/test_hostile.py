"""Hostile files and values: one line each, at once, and never a traceback."""

from __future__ import annotations

import os
import subprocess
import sys
import types
from pathlib import Path
from typing import Any

import pytest

import fiberbend
from fiberbend.reader.reader import read_case
from fiberbend.reader.yaml_file import MOST_BYTES
from fiberbend.schema.problems import LINES, CaseError, Problem, found, printable
from fiberbend.schema.units import parse, show
from tests.conftest import ROOT

SECTION = (ROOT / "cases" / "section.yaml").read_text(encoding="utf-8")


def laughs(value: str, again: str) -> str:
    """Aliases of aliases: 9¹² values of a kilobyte."""
    names = "abcdefghijklm"
    lines = [f"a: &a {value}"]
    for name, before in zip(names[1:], names, strict=False):
        lines.append(f"{name}: &{name} " + again % ", ".join([f"*{before}"] * 9))
    return "\n".join(lines)


def within(value: str) -> str:
    """The section with another radius."""
    assert "radius: 8 mm" in SECTION
    return SECTION.replace("radius: 8 mm", f"radius: {value}")


FILES = {
    "deep list": ("title: " + "[" * 500 + "]" * 500, "more than 50 values within values"),
    "deep mapping": ("\n".join(" " * i + "a:" for i in range(500)), "more than 50 values within"),
    "open lists": ("[" * 100_000, "more than 50 values within values"),
    "laughs": (laughs("[x, x]", "[%s]"), "more than 100000 values"),
    "merged laughs": (laughs("{x: 1}", "{<<: [%s]}"), "more than 100000 values"),
    "chain": (
        "\n".join(f"k{i}: &k{i} " + (f"[*k{i - 1}]" if i else "[x]") for i in range(400)),
        "more than 50 values within values",
    ),
    "itself": ("actuator: &a {radius: *a}", "a value within itself"),
    "merged itself": ("a: &a\n  <<: *a\n", "a value within itself"),
    "number key": ("1: 2\n" + SECTION, "the key '1' is no text, expected a name"),
    "date key": ("2001-01-01: 2\n" + SECTION, "the key '2001-01-01' is no text"),
    "no key": ("~: 2\n" + SECTION, "the key '~' is no text"),
    "list key": ("? [a]\n: 2\n" + SECTION, "a key that is no text"),
    "no date": (within("2001-99-99"), "'2001-99-99' is no timestamp"),
    "no zone": (within("2001-12-14t21:59:43.10-95:00"), "is no timestamp"),
    "long number": (within("8" * 100_000), "is no int"),
    "sexagesimal": (within("1" + ":59" * 100_000), "is no int"),
    "called a number": (within("!!int abc"), "'abc' is no int"),
    "called true": (within("!!bool abc"), "'abc' is no bool"),
    "half a character": (within('"\\uD800"'), "is no str"),
    "command": (within("!!python/object/apply:os.abort []"), "could not determine a constructor"),
    "escape": (SECTION + '"\\e[31mred\\n": 1\n', "\\x1b[31mred\\n: unknown key"),
    "date": (within("2001-01-01"), 'radius: "2001-01-01", expected a length'),
    "comment": (within('"8 mm # c"'), "there is no unit 'mm # c'"),
    "semicolon": (within("8 mm;"), "there is no unit 'mm;'"),
    "power of powers": (within("8 m**9**9**9"), "there is no unit 'm**9**9**9'"),
    "power in brackets": (within("8 m**(9**9)"), "there is no unit 'm**(9**9)'"),
    "superscripts": (within("8 m⁹⁹⁹⁹⁹⁹"), "there is no unit 'm⁹⁹⁹⁹⁹⁹'"),
    "letters": (within("8 " + "m" * 200_000), "expected a length with its unit"),
    "blanks": (within('"8' + " " * 200_000 + 'x"'), "expected a length with its unit"),
    "tiny": (within("1e-99999999999999999999 mm"), "expected a length from 1e-100 to 1e+100 mm"),
    "huge": (within("1e99999999999999999999 mm"), "expected a length that is finite"),
    "other digits": (within("٨ mm"), "expected a length with its unit"),
}
"""Text of a file, and what its only line must hold."""


@pytest.mark.timeout(20)
@pytest.mark.parametrize("name", FILES)
def test_a_hostile_file_is_one_line(name: str, tmp_path: Path) -> None:
    text, expected = FILES[name]
    path = tmp_path / "case.yaml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(CaseError) as error:
        read_case(path)
    (line,) = str(error.value).splitlines()
    assert expected in line
    assert len(line) < 400
    assert line.isprintable()


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"# " + b"x" * MOST_BYTES, "longer than 1 MB"),
        ("title: é".encode("latin-1"), "not text in UTF-8"),
        (SECTION.encode("utf-16-le"), "not text in UTF-8"),
        (SECTION.encode("utf-32"), "malformed YAML"),
        (SECTION.encode() + b"\0", "malformed YAML, unacceptable character #x0000"),
    ],
    ids=["long", "latin", "utf-16 without its mark", "utf-32", "nul"],
)
def test_bytes_that_are_no_yaml(content: bytes, expected: str, tmp_path: Path) -> None:
    path = tmp_path / "case.yaml"
    path.write_bytes(content)
    with pytest.raises(CaseError, match=expected):
        read_case(path)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_files_with_the_mark_of_their_encoding_are_read(encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "case.yaml"
    path.write_text(SECTION, encoding=encoding)
    assert read_case(path) == read_case(ROOT / "cases" / "section.yaml")


def cyclic() -> dict[str, Any]:
    value: dict[str, Any] = {}
    value["actuator"] = value
    return value


@pytest.mark.parametrize(
    "case",
    [
        *(None, 3, 3.0, True, [1], b"case.yaml", object(), "", "a\0b", "x" * 5000),
        *(ROOT, Path("/dev/zero"), {}, {1: 2}, {(1, 2): 3}, {"effects": {1, 2}}),
        *({"actuator": {"radius": 10**5000}}, cyclic(), types.MappingProxyType({"a": 3})),
    ],
    ids=lambda case: type(case).__name__,
)
def test_what_is_no_case_is_a_case_error(case: Any) -> None:
    with pytest.raises(CaseError) as error:
        fiberbend.run(case)
    assert all(line.isprintable() for line in str(error.value).splitlines())


def test_problems_beyond_the_first_are_counted() -> None:
    error = CaseError(Problem(f"k{i}", "unknown key") for i in range(LINES + 37))
    lines = str(error).splitlines()
    assert lines[LINES - 1 :] == [f"k{LINES - 1}: unknown key", "… and 37 more"]
    assert len(error.problems) == LINES + 37
    assert len(str(CaseError(error.problems[:LINES])).splitlines()) == LINES


def test_values_are_shown_whatever_they_are() -> None:
    assert found(10**5000) == "something of type int"
    assert found(cyclic()) == "something of type dict"
    assert printable("a\tb\x7f\ud800é") == "a\\tb\\x7f\\ud800é"


@pytest.mark.parametrize("tenths", range(-7200, 7201, 770))
def test_an_angle_is_shown_as_it_was_written(tenths: int) -> None:
    for text in (f"{tenths / 10:g} deg", f"{tenths // 10} deg"):
        assert show(parse(text, "angle"), "angle") == text


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("3 N/mm²", "pressure", 3.0),
        ("1 L/(min*bar)", "conductance", 1 / 60),
        ("2 kg·m⁻³", "density", 2e-12),
        ("2 kg m^-3", "density", 2e-12),
        ("3 cmH2O", "pressure", 294.1995e-6),
        ("1 m**2/m", "length", 1000.0),
        ("180 °", "angle", 3.141592653589793),
        ("8\u00a0mm", "length", 8.0),
        ("0e-99999999999999999999 m", "length", 0.0),
    ],
)
def test_unusual_units_are_read(text: str, kind: str, value: float) -> None:
    assert parse(text, kind) == pytest.approx(value, rel=1e-12)


def test_what_lies_beside_a_case_is_not_imported(tmp_path: Path) -> None:
    for module in ("yaml", "json", "numpy", "materials", "cyclopts", "socket", "pathlib", "email"):
        (tmp_path / f"{module}.py").write_text("raise SystemExit('imported from beside the case')")
    done = subprocess.run(
        [sys.executable, "-m", "fiberbend", "plan", str(ROOT / "cases" / "free_bending.yaml")],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_a_terminal_without_our_signs_and_a_name_that_is_no_text(tmp_path: Path) -> None:
    path = os.fsencode(tmp_path) + b"/\xff.yaml"
    Path(os.fsdecode(path)).write_text(SECTION.replace("title: ", "title: \u03b8 "))
    for arguments in ((b"validate", path), (b"validate", path, b"--set", b"a=1")):
        done = subprocess.run(
            [os.fsencode(sys.executable), b"-m", b"fiberbend", *arguments],
            cwd=ROOT,
            env=os.environ | {"PYTHONIOENCODING": "ascii"},
            capture_output=True,
        )
        assert done.returncode == (1 if b"--set" in arguments else 0)
        assert b"Traceback" not in done.stderr
        assert len(done.stderr.splitlines()) == (1 if b"--set" in arguments else 0)
