"""`fiberbend init` writes a valid case; what is wrong is refused with its place."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fiberbend.cli import main
from fiberbend.reader.json_schema import json_schema
from fiberbend.reader.new_case import chamber_dimensions, spaced
from fiberbend.reader.reader import read_case
from geometry.sections.table import SECTIONS


def case_of(path: Path, *options: str) -> Path:
    assert main(["init", str(path), *options]) == 0
    return path


def test_a_new_case_says_what_was_given(tmp_path: Path) -> None:
    path = case_of(
        tmp_path / "my_finger.yaml",
        *("--radius", "6.35mm", "--length", "8cm", "--wall", "1.5mm", "dragon-skin-30"),
        *("--sheath", "1", "mm", "--pitch", "4 mm", "--angle", "90deg"),
    )
    case = read_case(path)
    assert case.title == "My finger"
    assert (case.actuator.radius, case.actuator.length) == (6.35, 80.0)
    assert (case.actuator.wall, case.materials.wall.name) == (1.5, "dragon-skin-30")
    assert case.actuator.sheath == 1.0
    assert case.turns is not None
    assert case.turns.pitch == 4.0
    assert len(case.output.at_angles) == 2
    assert case.output.at_angles[1] == pytest.approx(2 * case.output.at_angles[0])
    text = path.read_text()
    assert text.count("#") > 10, "every line of dimensions says what it is"
    assert len([line for line in text.splitlines() if line]) <= 25
    assert max(map(len, text.splitlines())) <= 100


def test_its_first_line_names_the_schema_beside_it(tmp_path: Path) -> None:
    path = case_of(tmp_path / "finger.yaml")
    _, _, name = path.read_text().splitlines()[0].partition("$schema=")
    assert json.loads((tmp_path / name).read_text()) == json_schema()
    # a second case in the same folder uses the same one
    case_of(tmp_path / "thumb.yaml")


def test_a_foreign_schema_is_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = tmp_path / "case.schema.json"
    other.write_text('{"title": "another tool"}')
    assert main(["init", str(tmp_path / "finger.yaml")]) == 1
    assert "case.schema.json" in capsys.readouterr().err
    assert other.read_text() == '{"title": "another tool"}'
    assert not (tmp_path / "finger.yaml").exists()


@pytest.mark.parametrize("section", SECTIONS)
def test_every_section_has_a_valid_case(section: str, tmp_path: Path) -> None:
    case = read_case(case_of(tmp_path / "a.yaml", "--section", section))
    assert case.actuator.section == section
    assert all(getattr(case.actuator, name) for name in chamber_dimensions(section))


def test_a_pressure_is_all_that_a_case_asks_for(tmp_path: Path) -> None:
    """An angle to stop at counts as asked for: where it is not reached, a run is not converged."""
    case = read_case(case_of(tmp_path / "a.yaml", "--pressure", "7.5 psi"))
    assert case.output.stop_at_angle is None
    assert case.output.at_angles == ()
    assert len(case.output.at_pressures) == 2


def test_a_blocked_one_asks_for_its_force(tmp_path: Path) -> None:
    case = read_case(case_of(tmp_path / "a.yaml", "--blocked", "--pressure", "80kPa"))
    assert case.straight
    assert case.inflation is not None
    assert case.inflation.to == 0.08
    assert case.output.at_pressures == (0.04, 0.08)


@pytest.mark.parametrize(
    ("options", "place"),
    [
        (["--radius", "8"], "actuator.radius"),
        (["--wall", "dragonskin-30"], "did you mean dragon-skin-30?"),
        (["--wall", "ecoflex-0030", "elastosil-m4601"], "--wall"),
        (["--section", "oval"], "--section"),
        (["--section", "circle", "--width", "3 mm"], "--width"),
        (["--floor", "none"], "actuator.floor"),
        (["--pressure", "80 kPa", "--angle", "90 deg"], "--angle"),
        (["--blocked", "--angle", "90 deg"], "--angle"),
        (["--pitch", "0.01 mm"], "pitch"),
        (["--fiber", "nylon"], "fiber"),
    ],
)
def test_what_is_wrong_is_named_and_nothing_written(
    options: list[str], place: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["init", str(tmp_path / "a.yaml"), *options]) == 1
    assert place in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_case_that_is_there_is_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("mine\n")
    assert main(["init", str(path)]) == 1
    assert "--overwrite" in capsys.readouterr().err
    assert path.read_text() == "mine\n"
    assert main(["init", str(path), "--overwrite"]) == 0
    assert main(["init", str(tmp_path / "a.txt")]) == 1


def test_questions_are_asked_on_a_terminal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answers = {"radius": "7 mm", "sheath": "2 mm", "end": "90 kPa"}
    asked = []

    def reply(question: str) -> str:
        asked.append(question)
        return next((text for key, text in answers.items() if question.startswith(key)), "")

    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("builtins.input", reply)
    case = read_case(case_of(tmp_path / "a.yaml"))
    assert case.actuator.radius == 7.0
    assert case.actuator.sheath == 2.0
    assert case.inflation is not None
    assert case.inflation.to == 0.09
    assert len(asked) == 9


def test_a_wrong_answer_is_asked_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    answers = {
        "shape": ["oval", "rectangle"],
        "width": ["20", "-20 mm", "20mm"],
        "wall": ["3mm dragonskin-30", "3mm dragon-skin-30"],
        "what to compute": ["both", "force"],
        "pressure": ["90 mm", "90 kPa"],
    }

    def reply(question: str) -> str:
        left = next((left for key, left in answers.items() if question.startswith(key)), [])
        return left.pop(0) if left else ""

    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("builtins.input", reply)
    case = read_case(case_of(tmp_path / "a.yaml"))
    assert not any(answers.values())
    assert (case.actuator.width, case.actuator.wall) == (20.0, 3.0)
    assert case.straight
    said = capsys.readouterr().out
    assert "did you mean dragon-skin-30?" in said
    assert '"-20 mm", expected a length above zero' in said
    assert "expected bend or force" in said


def test_the_next_commands_can_be_pasted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = case_of(tmp_path / "new folder" / "my finger.yaml", "--radius", "7 mm")
    assert f"  fiberbend run '{path}'\n" in capsys.readouterr().out


def test_a_space_goes_before_a_unit() -> None:
    assert spaced("2mm") == "2 mm"
    assert spaced("1e-3 m") == "1e-3 m"
    assert spaced("nonsense") == "nonsense"
