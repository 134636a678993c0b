"""Materials of a case by names, moduli, files of one's own and tests; fabrics of strips."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend import CaseError
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.effects.strip import StripEffect
from fiberbend.effects.winding import WindingEffect
from fiberbend.reader.json_schema import json_schema
from fiberbend.reader.reader import as_case, read_case
from fiberbend.schema.paths import value_at
from fiberbend.sweep.points import read_sweep
from materials.named.entry import DATA
from materials.named.table import SHEETS_BY_NAME, SOLIDS, THREADS_BY_NAME
from tests.conftest import ROOT

SECTION = ROOT / "cases" / "section.yaml"
TEST = DATA / "dragon-skin-30.csv"
OWN = """law: yeoh
c1: 0.1123456789 MPa
c2: 0.0212345678 MPa
density: 1.08 g/cm^3
tested: [1, 2.5]
source: a test of March
"""


def complaint(settings: dict[str, Any]) -> list[str]:
    with pytest.raises(CaseError) as error:
        as_case(SECTION, settings)
    return [f"{problem.path}: {problem.text}" for problem in error.value.problems]


def wall(settings: Any) -> Any:
    return convert.material(as_case(SECTION, {"materials.wall": settings}).materials.wall)


# --- names --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SOLIDS)
def test_every_name_may_stand_in_a_case(name: str) -> None:
    case = as_case(SECTION, {"materials.wall": name})
    assert case.resolved()["materials"]["wall"] == name
    assert as_case(case.resolved()) == case


def enums(schema: Any) -> set[frozenset[str]]:
    """Every list of words within a schema."""
    if isinstance(schema, dict):
        own = {frozenset(schema["enum"])} if "enum" in schema else set()
        return own.union(*(enums(value) for value in schema.values()))
    return set[frozenset[str]]().union(*map(enums, schema)) if isinstance(schema, list) else set()


def test_the_schema_suggests_all_names_and_takes_own_files() -> None:
    jsonschema = pytest.importorskip("jsonschema")
    schema = json_schema()
    assert {frozenset(SOLIDS), frozenset(THREADS_BY_NAME), frozenset(SHEETS_BY_NAME)} <= enums(
        schema
    )
    data = yaml.safe_load(SECTION.read_text(encoding="utf-8"))
    for value, good in {
        "dragon-skin-10": True,
        "my-rubber.yaml": True,
        "my-rubber.yml": True,
        "dragon-skin": False,
    }.items():
        data["materials"]["wall"] = value
        valid = jsonschema.Draft202012Validator(schema).is_valid(data)
        assert valid is good, value


def test_unknown_names_are_told_near_ones() -> None:
    (line,) = complaint({"materials.wall": "ecoflex"})
    assert line.startswith('materials.wall: "ecoflex", expected ecoflex-00')
    assert "`fiberbend materials` lists" in line
    (line,) = complaint({"materials.wall": "kevlar"})
    assert "expected another kind than a thread" in line
    (line,) = complaint({"effects.1.winding.fiber": "ecoflex-0030"})
    assert "expected another kind than a rubber" in line


# --- Young's modulus ----------------------------------------------------------------------------


def test_moduli_of_youngs_modulus_and_poissons_ratio() -> None:
    rubber = wall({"young": "0.9 MPa"})
    assert (rubber.law, rubber.parameters["mu"], rubber.bulk) == ("neo-hooke", 0.3, None)
    assert wall({"young": "0.9 MPa", "poisson": 0.5}) == rubber
    soft = wall({"young": "0.9 MPa", "poisson": 0.45})
    shear, bulk = soft.parameters["mu"], soft.bulk
    assert 9 * bulk * shear / (3 * bulk + shear) == pytest.approx(0.9, rel=1e-13)
    assert (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear) == pytest.approx(0.45, rel=1e-13)


@pytest.mark.parametrize(
    ("material", "line"),
    [
        ({"young": "1 MPa", "poisson": 0.6}, "materials.wall.poisson: 0.6, expected at most 0.5"),
        ({"young": "1 MPa", "poisson": -0.1}, "materials.wall.poisson: -0.1, expected at least 0"),
        ({"young": "1 MPa", "c1": "1 MPa"}, "materials.wall.c1: no effect beside young"),
        ({"young": "1 MPa", "law": "yeoh"}, "materials.wall.law: no effect beside young"),
        ({"young": "1 MPa", "bulk": "9 MPa"}, "materials.wall.bulk: no effect beside young"),
        ({"law": "neo-hooke", "mu": "1 MPa", "poisson": 0.4}, "materials.wall.poisson: no effect"),
        ({"name": "ecoflex-0030", "young": "1 MPa"}, "materials.wall.young: no effect on a named"),
        ({"name": "ecoflex-0030", "tested": [1, 2]}, "materials.wall.tested: no effect on a"),
        ({"poisson": 0.5}, "materials.wall: neither name nor law"),
        ({"young": "1 MPa", "upto": 2}, "materials.wall.upto: no effect without data"),
        ({"law": "yeoh", "c1": "1 MPa", "tested": [2, 3]}, "materials.wall: tested 2 to 3"),
    ],
)
def test_forms_that_say_nothing_are_refused(material: Any, line: str) -> None:
    assert any(text.startswith(line) for text in complaint({"materials.wall": material}))


# --- a file of one's own ------------------------------------------------------------------------


def write_case(folder: Path, **changes: Any) -> Path:
    data = yaml.safe_load(SECTION.read_text(encoding="utf-8"))
    data["materials"] |= changes
    path = folder / "own.yaml"
    path.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
    return path


def test_an_own_file_is_the_same_numbers_in_the_case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "my-rubber.yaml").write_text(OWN, encoding="utf-8")
    path = write_case(tmp_path, wall="my-rubber.yaml")
    monkeypatch.chdir(ROOT)
    own = read_case(path)
    said = yaml.safe_load(OWN)
    # without gravity nobody asks for a density
    del said["density"]
    there = read_case(
        write_case(tmp_path, wall=said | {"source": "my-rubber.yaml: a test of March"})
    )
    assert own == there
    assert own.materials.wall.coefficients == {"c1": 0.1123456789, "c2": 0.0212345678}
    assert convert.material(own.materials.wall).tested == (1.0, 2.5)
    assert own.resolved()["materials"]["wall"]["source"] == "my-rubber.yaml: a test of March"
    assert as_case(own.resolved()) == own


def test_an_own_file_has_its_density_where_something_weighs(tmp_path: Path) -> None:
    (tmp_path / "my-rubber.yaml").write_text(OWN, encoding="utf-8")
    file = str(tmp_path / "my-rubber.yaml")
    settings = {
        "materials": {"wall": file, "floor": file, "sheath": file},
        "effects.2": {"gravity": {"direction": "-y"}},
        "model": "body",
    }
    case = as_case(SECTION, settings)
    assert case.materials.wall.density == pytest.approx(1.08e-9)


@pytest.mark.parametrize(
    ("content", "lines"),
    [
        (
            "law: yeoh\nc2: 1 MPa\n\nc9: 1 MPa\n",
            ["materials.wall.c9: my.yaml, line 4: unknown key"],
        ),
        (
            "law: yeoh\nc2: 1 MPa\n",
            ["materials.wall.c1: my.yaml: missing, expected a coefficient of yeoh"],
        ),
        ("law: yoeh\nc1: 1 MPa\n", ['materials.wall.law: my.yaml, line 1: "yoeh", expected yeoh']),
        ("name: other.yaml\n", ["materials.wall: my.yaml: "]),
        ("- 1\n", ["materials.wall: my.yaml: contains no mapping, expected a material"]),
        ("law: [\n", ["materials.wall: my.yaml, line 2: malformed YAML"]),
        ("law: yeoh\nc1: 1 MPa\ndensity: 3\n", ["materials.wall.density: my.yaml, line 3: 3"]),
    ],
)
def test_what_is_wrong_in_an_own_file_has_its_name(
    tmp_path: Path, content: str, lines: list[str]
) -> None:
    (tmp_path / "my.yaml").write_text(content, encoding="utf-8")
    found = complaint({"materials.wall": str(tmp_path / "my.yaml")})
    for begin in lines:
        assert any(line.startswith(begin) for line in found), found


@pytest.mark.parametrize(
    ("field", "text", "name"),
    [
        ("materials.wall", "name: dragon-skin-30\n", "dragon-skin-30"),
        ("materials.wall", "name: dragon-skin-30\ndensity: 1 g/cm^3\n", "dragon-skin-30"),
        ("effects.1.winding.fiber", "name: nylon\ndiameter: 0.3 mm\n", "nylon"),
    ],
)
def test_an_own_file_may_have_a_name_of_the_table(
    field: str, text: str, name: str, tmp_path: Path
) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(text, encoding="utf-8")
    found = value_at(as_case(SECTION, {field: str(path)}).resolved(), field)
    assert (found if isinstance(found, str) else found["name"]) == name


def test_a_file_that_is_not_there() -> None:
    (line,) = complaint({"materials.wall": "none.yaml"})
    assert line == "materials.wall: none.yaml: no such file, expected a file of a material"


def test_threads_and_fabrics_of_own_files(tmp_path: Path) -> None:
    (tmp_path / "thread.yaml").write_text("modulus: 3 GPa\ndiameter: 0.3 mm\n", encoding="utf-8")
    (tmp_path / "cloth.yaml").write_text("modulus: 2 GPa\nthickness: 0.2 mm\n", encoding="utf-8")
    strip = {"at": "bottom", "width": "6 mm", "fabric": str(tmp_path / "cloth.yaml")}
    settings = {
        "effects.1.winding.fiber": str(tmp_path / "thread.yaml"),
        "effects.2": {"strip": strip},
    }
    case = as_case(SECTION, settings)
    winding, cloth = case.find(WindingEffect), case.find(StripEffect)
    assert winding is not None
    assert winding.fiber is not None
    assert (winding.fiber.modulus, winding.fiber.diameter) == (3000.0, 0.3)
    assert winding.fiber.source == "thread.yaml"
    assert cloth is not None
    assert cloth.stiffness == pytest.approx(400.0)
    assert as_case(case.resolved()) == case
    (tmp_path / "cloth.yaml").write_text("modulus: 2 GPa\nthicknes: 0.2 mm\n", encoding="utf-8")
    found = complaint(settings)
    assert any("thicknes: cloth.yaml, line 2: unknown key" in line for line in found), found


def test_a_sweep_has_own_files_too(tmp_path: Path) -> None:
    for name, c1 in (("a", 0.1), ("b", 0.2)):
        text = f"law: yeoh\nc1: {c1} MPa\n"
        (tmp_path / f"{name}.yaml").write_text(text, encoding="utf-8")
    sweep = {"case": str(SECTION), "vary": {"materials.wall": ["a.yaml", "b.yaml"]}}
    path = tmp_path / "sweep.yaml"
    path.write_text(yaml.safe_dump(sweep), encoding="utf-8")
    points = read_sweep(path).points
    assert [p.case.materials.wall.coefficients["c1"] for p in points] == [0.1, 0.2]


def test_a_mapping_takes_paths_of_python_too(tmp_path: Path) -> None:
    (tmp_path / "soft.yaml").write_text("law: neo-hooke\nmu: 0.4 MPa\n", encoding="utf-8")
    assert wall(tmp_path / "soft.yaml").parameters == {"mu": 0.4}
    assert wall({"data": TEST, "law": "yeoh-2"}) == wall({"data": str(TEST), "law": "yeoh-2"})
    several = {"data": {"uniaxial": TEST}, "law": "yeoh-2"}
    assert wall(several) == wall({"data": str(TEST), "law": "yeoh-2"})


@pytest.mark.parametrize("part", ["set", "vary", "points"])
@pytest.mark.parametrize(
    ("field", "value", "read"),
    [
        ("effects.1.winding.fiber", "thread.yaml", "effects.1.winding.fiber.modulus"),
        ("materials.wall.data", "pull.csv", "materials.wall.mu"),
        (
            "materials",
            {"wall": "soft.yaml", "floor": "soft.yaml", "sheath": "soft.yaml"},
            "materials.floor.mu",
        ),
    ],
)
def test_files_of_a_sweep_are_seen_from_its_file_whatever_is_changed(
    part: str, field: str, value: Any, read: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for folder, size in (("near", 1), ("far", 9)):
        (tmp_path / folder).mkdir()
        for name, text in {
            "thread.yaml": f"modulus: {size} GPa\ndiameter: 0.4 mm\n",
            "soft.yaml": f"law: neo-hooke\nmu: {size} MPa\n",
            "pull.csv": "stretch,nominal stress [MPa]\n"
            + "".join(f"{s},{size * (s - s**-2)}\n" for s in (1.1, 1.2, 1.3)),
        }.items():
            (tmp_path / folder / name).write_text(text, encoding="utf-8")
    sweep: dict[str, Any] = {"case": yaml.safe_load(SECTION.read_text(encoding="utf-8"))}
    sweep["case"]["materials"]["wall"] = {"law": "neo-hooke", "data": "dragon-skin-30"}
    ways: dict[str, dict[str, Any]] = {
        "set": {"set": {field: value}, "vary": {"actuator.wall": ["2 mm"]}},
        "vary": {"vary": {field: [value]}},
        "points": {"points": [{field: value}]},
    }
    sweep |= ways[part]
    path = tmp_path / "near" / "sweep.yaml"
    path.write_text(yaml.safe_dump(sweep), encoding="utf-8")
    monkeypatch.chdir(tmp_path / "far")
    (point,) = read_sweep(path).points
    found = value_at(point.case.resolved(), read)
    assert float(found.split()[0]) == pytest.approx(1000 if "fiber" in field else 1)
    assert found.endswith(" MPa")


# --- fabrics of strips --------------------------------------------------------------------------


def strips(**more: Any) -> dict[str, Any]:
    return {"effects.2": {"strip": {"at": "bottom", "width": "6 mm", **more}}}


def test_a_strip_of_a_named_paper() -> None:
    def stiffness(case: Case) -> float:
        strip = case.find(StripEffect)
        assert strip is not None
        return strip.stiffness

    named = as_case(SECTION, strips(fabric="printer-paper", thickness="0.1 mm"))
    given = as_case(SECTION, strips(modulus="5320 MPa", thickness="0.1 mm"))
    assert stiffness(named) == stiffness(given) == pytest.approx(532.0)
    assert as_case(named.resolved()) == named


@pytest.mark.parametrize(
    ("more", "line"),
    [
        ({"fabric": "printer-paper"}, "effects.2.strip.thickness: missing, expected a length"),
        ({"thickness": "1 mm"}, "effects.2.strip.modulus: missing, expected a modulus"),
        ({"modulus": "1 GPa"}, "effects.2.strip.thickness: missing, expected a length"),
        (
            {"fabric": "printer-paper", "thickness": "1 mm", "modulus": "1 GPa"},
            "effects.2.strip.modulus: no effect beside printer-paper",
        ),
        ({"fabric": "paper"}, 'effects.2.strip.fabric: "paper", expected printer-paper'),
        ({"fabric": "kevlar"}, 'effects.2.strip.fabric: "kevlar", expected another kind than a'),
    ],
)
def test_strips_that_say_too_little_or_too_much(more: dict[str, Any], line: str) -> None:
    assert any(text.startswith(line) for text in complaint(strips(**more)))


def test_the_schema_of_the_cases_is_that_of_the_code() -> None:
    text = (ROOT / "cases" / "case.schema.json").read_text(encoding="utf-8")
    assert json.loads(text) == json_schema()
