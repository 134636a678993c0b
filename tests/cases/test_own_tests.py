"""Laws of a case that are fitted to tests of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from fiberbend import CaseError
from fiberbend.reader.reader import as_case, read_case
from materials.fit.fit import fit_law
from materials.fit.modes import MODES, Measurement
from materials.named.entry import DATA
from materials.named.table import RUBBERS
from tests.cases.test_own_materials import SECTION, TEST, complaint, write_case

# --- tests of one's own -------------------------------------------------------------------------


def test_a_law_is_fitted_to_a_test(tmp_path: Path) -> None:
    (tmp_path / "tensile.csv").write_bytes(TEST.read_bytes())
    data = {"data": "tensile.csv", "law": "yeoh-2", "upto": 2}
    case = read_case(write_case(tmp_path, wall=data))
    from fiberbend.tensile.reading import Wanted, read_test

    fit = fit_law("yeoh-2", [read_test(TEST, "uniaxial", Wanted(most=2.0)).measurement])
    assert case.materials.wall.law == "yeoh"
    assert case.materials.wall.coefficients == fit.parameters
    # those of the table, which has fewer digits
    stored = RUBBERS["dragon-skin-30"].coefficients
    assert case.materials.wall.coefficients["c1"] == pytest.approx(stored["c1"], rel=1e-3)
    resolved = case.resolved()["materials"]["wall"]
    assert "data" not in resolved
    assert resolved["source"].startswith("yeoh-2 fitted to tensile.csv from a stretch of 1 to 1.9")
    assert as_case(case.resolved()) == case
    shipped = as_case(SECTION, {"materials.wall": data | {"data": "dragon-skin-30"}})
    assert shipped.materials.wall.coefficients == fit.parameters
    (tmp_path / "my.yaml").write_text(yaml.safe_dump(data), encoding="utf-8")
    from_file = read_case(write_case(tmp_path, wall="my.yaml"))
    assert from_file.materials.wall.coefficients == case.materials.wall.coefficients


def test_a_law_is_fitted_to_a_test_in_compression(tmp_path: Path) -> None:
    rows = "".join(f"{s},{0.3 * (s - s**-2)}\n" for s in (0.95, 0.9, 0.8, 0.7))
    head = "stretch,nominal stress [MPa]\n"
    (tmp_path / "pressed.csv").write_text(head + rows, encoding="utf-8")
    case = read_case(write_case(tmp_path, wall={"data": "pressed.csv", "law": "neo-hooke"}))
    assert case.materials.wall.coefficients["mu"] == pytest.approx(0.3)
    assert case.materials.wall.tested == (0.7, 1.0)


def test_the_source_says_what_the_tests_do_not_settle() -> None:
    def source(law: str) -> str:
        data = {"data": "dragon-skin-30", "law": law, "upto": 2}
        return str(as_case(SECTION, {"materials.wall": data}).materials.wall.source)

    assert source("ogden-1").endswith("of the greatest stress")
    assert "nearly cancel" in source("ogden")
    assert source("ogden-2").endswith("the tests do not settle mu1, alpha1")


def test_options_that_a_case_cannot_give_are_told_to_be_those_of_fit(tmp_path: Path) -> None:
    text = "strain [%],stress [MPa]\n10,0.1\n20,0.2\n30,0.3\n"
    (tmp_path / "plain.csv").write_text(text, encoding="utf-8")
    (line,) = complaint({"materials.wall": {"data": f"{tmp_path}/plain.csv", "law": "neo-hooke"}})
    assert "or --as true: options of `fiberbend fit`, whose material file a case takes" in line


def test_a_name_of_a_test_is_no_file_of_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "case" / "dragon-skin-30").mkdir(parents=True)
    (tmp_path / "far").mkdir()
    data: dict[str, Any] = {"data": "dragon-skin-30", "law": "neo-hooke", "upto": 2}
    path = write_case(tmp_path / "case", wall=data)
    known = read_case(path)
    other = "stretch,nominal stress [MPa]\n1.1,1\n1.2,2\n1.3,3\n"
    (tmp_path / "far" / "dragon-skin-30").write_text(other, encoding="utf-8")
    monkeypatch.chdir(tmp_path / "far")
    assert read_case(path) == known
    # one beside the case goes before it, one that is missed in another folder is missed
    own = write_case(tmp_path / "far", wall=data)
    assert read_case(own) != known
    lost = write_case(tmp_path / "case", wall=data | {"data": "tests/dragon-skin-30"})
    with pytest.raises(CaseError, match="dragon-skin-30: No such file"):
        read_case(lost)


def test_a_law_is_fitted_to_tests_of_several_kinds(tmp_path: Path) -> None:
    files = {way: str(DATA / f"kawabata-1981-{way}.csv") for way in MODES}
    case = as_case(SECTION, {"materials.wall": {"data": files, "law": "ogden-2"}})
    tests = []
    for way, file in files.items():
        stretch, stress = np.loadtxt(file, delimiter=",", skiprows=1).T
        tests.append(Measurement(MODES[way], stretch, stress))
    assert case.materials.wall.coefficients == pytest.approx(
        fit_law("ogden-2", tests).parameters, rel=1e-6
    )


@pytest.mark.parametrize(
    ("material", "line"),
    [
        ({"data": "none.csv", "law": "yeoh"}, "materials.wall.data: none.csv: No such file"),
        ({"data": str(SECTION), "law": "yeoh"}, "materials.wall.data: section.yaml: "),
        ({"data": str(TEST)}, "materials.wall.law: missing, expected a law to fit"),
        ({"data": str(TEST), "law": "yoeh"}, "materials.wall.law: law 'yoeh', expected one of"),
        ({"data": str(TEST), "law": "yeoh", "c1": "1 MPa"}, "materials.wall.c1: no effect beside"),
        ({"data": str(TEST), "law": "yeoh", "upto": "x"}, 'materials.wall.upto: "x", expected'),
        ({"data": str(TEST), "law": "yeoh", "upto": 0.5}, "materials.wall"),
        ({"data": {"shear": "a.csv"}, "law": "yeoh"}, "materials.wall.data.shear: unknown key"),
        ({"data": {}, "law": "yeoh"}, "materials.wall.data: no test, expected one of"),
        ({"data": [1], "law": "yeoh"}, "materials.wall.data: [1], expected the name of a file"),
    ],
)
def test_tests_that_cannot_be_fitted_are_refused(material: Any, line: str) -> None:
    assert any(text.startswith(line) for text in complaint({"materials.wall": material}))
