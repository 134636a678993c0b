"""`fiberbend fit`: what it prints, writes and refuses, and the band on the pressure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import fiberbend
from fiberbend import cli
from fiberbend.api.fitting import Fitted
from fiberbend.fit.comparison import Asked, compared
from fiberbend.fit.words import with_error
from fiberbend.tensile.reading import Wanted
from fiberbend.tensile.shipped import file_of
from materials.fit.modes import UNIAXIAL
from tests.conftest import ROOT

SECTION = ROOT / "cases" / "section.yaml"
QUICK = ["mesh.section=1", "output.at_angles=[90 deg, 180 deg]"]
RUBBER = "dragon-skin-30"


def fitted(*laws: str, most: float = 2.0) -> Fitted:
    return fiberbend.fit(RUBBER, laws, upto=f"stretch {most}")


def test_a_fit_is_printed_and_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    command = ["fit", RUBBER, "--upto", "stretch 2", "--law", "yeoh-2,gent", "--out", "my.yaml"]
    assert cli.main([*command, "--density", "1.08 g/cm^3"]) == 0
    printed = capsys.readouterr().out
    assert "yeoh-2  0.67 %     +0.0" in printed
    assert "c1 90.4 ± 2.5 kPa, c2 9.08 ± 0.55 kPa" in printed
    assert "only uniaxial was measured" in printed
    assert "pure-shear (2) *  equibiaxial (2) *" in printed
    assert "wall: {law: yeoh, c1: 0.0904126 MPa, c2: 0.00908234 MPa}" in printed
    written = yaml.safe_load((tmp_path / "my.yaml").read_text(encoding="utf-8"))
    assert written == {
        "law": "yeoh",
        "c1": "0.0904126 MPa",
        "c2": "0.00908234 MPa",
        "density": "1.08 g/cm^3",
        "tested": [1, 1.977],
        "source": "yeoh-2 fitted to dragon-skin-30.csv (uniaxial)",
    }
    assert (tmp_path / "my.png").stat().st_size > 10_000
    # what is there is not replaced unless it is asked for
    assert cli.main(command) == 1
    assert "my.yaml: exists" in capsys.readouterr().err
    assert cli.main([*command, "--overwrite"]) == 0


REFUSED = {
    "no test": ([], "no test, expected a file"),
    "no file": (["none.csv"], "none.csv: No such file or directory, expected a file"),
    "a law": ([RUBBER, "--law", "yeah"], "--law: law 'yeah', expected one of yeoh (yeoh-1 to -3)"),
    "a limit": ([RUBBER, "--upto", "1.5"], '--upto: "1.5", expected a limit such as "stretch 1.5"'),
    "a cycle": ([RUBBER, "--cycle", "2"], "one loading and no cycles"),
    "a name": ([RUBBER, "--out", "my.csv"], "expected a name that ends in .yaml"),
    "one side": ([RUBBER, "--width", "6 mm"], "expected --width and --thickness together"),
    "a density": ([RUBBER, "--density", "1.08"], "expected a density with its unit"),
    "a part": ([RUBBER, "--case", str(SECTION), "--part", "roof"], "--part: 'roof', expected"),
    "no uniform bending": (
        [RUBBER, "--case", str(ROOT / "cases" / "blocked_tip.yaml")],
        "expected section or cell",
    ),
    "too few points": (
        [RUBBER, "--law", "ogden", "--upto", "stretch 1.1"],
        "ogden has 6 parameters, expected more points",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refusals_are_one_line_and_write_nothing(
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    arguments, message = REFUSED[name]
    assert cli.main(["fit", *arguments]) == 1
    error = capsys.readouterr().err
    assert message in error
    assert len(error.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_all_modes_at_once() -> None:
    found = fiberbend.fit(
        "treloar-1944-uniaxial",
        "ogden",
        pure_shear="treloar-1944-pure-shear",
        equibiaxial=["treloar-1944-equibiaxial"],
    )
    assert found.found.measured == ("uniaxial", "pure-shear", "equibiaxial")
    assert found.found.best.rms < 0.02
    # near Ogden's own numbers for this rubber, 1972: exponents 1.3, 5.0, −2.0
    exponents = sorted(v for k, v in found.parameters.items() if k.startswith("alpha"))
    assert exponents == pytest.approx([-2.36, 1.74, 7.01], abs=0.02)
    assert "was measured" not in str(found)


def test_the_usual_laws_are_compared() -> None:
    found = compared(Asked((("uniaxial", Path(RUBBER)),), wanted=Wanted(most=2.0)))
    criteria = [fit.criterion for fit in found.fits]
    assert criteria == sorted(criteria)
    assert found.best.form.name == "ogden-1"
    wide = compared(Asked((("uniaxial", Path(RUBBER)),), ("ogden-2", "ogden-1")))
    assert [fit.form.name for fit in wide.fits] == ["ogden-1", "ogden-2"]
    assert wide.fits[1].criterion < wide.fits[0].criterion
    few = compared(Asked((("uniaxial", Path("treloar-1944-uniaxial")),), wanted=Wanted(most=1.3)))
    assert [text.split(":")[0] for text in few.left_out] == ["yeoh", "ogden-2"]


def test_tests_that_are_not_fitted_are_compared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # a law that fits one mode best may be off by a factor in another
    monkeypatch.chdir(tmp_path)
    command = ["fit", "meunier-2008-uniaxial", "--equibiaxial", "meunier-2008-equibiaxial"]
    command += ["--only", "uniaxial", "--from", "stretch 1", "--upto", "stretch 1.5"]
    assert cli.main([*command, "--law", "yeoh-2,ogden-1,neo-hooke"]) == 0
    printed = capsys.readouterr().out
    assert "yeoh-2     -24.5 %" in printed
    assert "ogden-1    +3587.3 %" in printed
    assert "only uniaxial was fitted" in printed
    assert cli.main([*command, "--only", "pure-shear", "--overwrite"]) == 0
    assert cli.main([*command[:4], "--only", "pure-shear", "--overwrite"]) == 1
    assert "no test in pure-shear" in capsys.readouterr().err


def test_frame_and_covariance() -> None:
    found = fitted("yeoh-2", "gent")
    assert list(found.frame["law"]) == ["yeoh-2", "yeoh-2", "gent", "gent"]
    assert found.laws == ("yeoh-2", "gent")
    assert found.material.parameters == found.parameters
    errors = np.sqrt(np.diag(found.covariance))
    assert dict(zip(found.covariance.columns, errors, strict=True)) == pytest.approx(found.errors)
    assert "<table" in found._repr_html_()
    with pytest.raises(KeyError, match="expected one of yeoh-2, gent"):
        found.law("ogden")
    assert len(found.plot().axes) == 6


def test_errors_have_two_digits() -> None:
    assert with_error(90.4129, 2.512) == "90.4 ± 2.5"
    assert with_error(1178.2, 157.3) == "1178 ± 157"
    assert with_error(-0.0417, 0.0453) == "-0.042 ± 0.045"
    assert with_error(3.0, 1e4) == "3 (not settled)"
    assert with_error(0.3, 0.0) == "0.3"


def test_the_band_covers_refits_to_resampled_tests() -> None:
    # its standard errors are those of the fit, carried to the pressure along its covariance
    band = fitted("yeoh-2").band(SECTION, refits=40, settings=QUICK, seed=1)
    assert 0.9 <= band.covered <= 0.99
    spread = np.std(band.refits, axis=0)
    assert spread == pytest.approx(band.error, rel=0.25)
    assert np.mean(band.refits, axis=0) == pytest.approx(band.pressure, rel=0.01)


def test_the_band_is_what_linear_moduli_make_of_it() -> None:
    # with neo-Hooke alone in the wall the pressure is nearly linear in μ: δP = ∂P/∂μ δμ
    found = fitted("neo-hooke")
    band = found.band(SECTION, settings=QUICK)
    from fiberbend.fit.band import pressures

    case = fiberbend.validate(SECTION, settings=QUICK)
    best = found.found.best
    step = 0.01 * best.values
    up, down = (
        pressures(case, "wall", best.with_values(best.values + sign * step), band.angles)[0]
        for sign in (1, -1)
    )
    slope = (up - down) / (2 * step[0])
    assert band.error == pytest.approx(slope * found.errors["mu"], rel=0.01)


def test_what_lies_beyond_the_tests_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    case = tmp_path / "case.yaml"
    text = SECTION.read_text(encoding="utf-8")
    case.write_text(text + "mesh: {section: 1}\n", encoding="utf-8")
    command = ["fit", RUBBER, "--law", "yeoh-2", "--upto", "stretch 1.3", "--case", str(case)]
    assert cli.main(command) == 0
    printed = capsys.readouterr().out
    assert "from 270° on rubber is stretched beyond the tests, which end at 1.3" in printed
    assert (tmp_path / "dragon-skin-30_pressure.png").exists()


def test_a_fit_says_the_stress_of_its_material() -> None:
    best = fitted("ogden-1").found.best
    stretch = np.linspace(1, 2, 7)
    along, _, free = best.material.principal(*UNIAXIAL.stretches(stretch))
    assert best.stress(UNIAXIAL, stretch) == pytest.approx((along - free) / stretch, rel=1e-12)


def test_commas_that_may_be_thousands_are_read_as_told(tmp_path: Path) -> None:
    rows = [(s, 6 * (s - s**-2)) for s in (1.15, 1.2, 1.25, 1.3)]
    text = "".join(f"{s:.3f};{p:.3f}\n" for s, p in rows).replace(".", ",")
    path = tmp_path / "commas.csv"
    path.write_text(f"stretch;nominal stress [MPa]\n{text}", encoding="utf-8")
    with pytest.raises(fiberbend.CaseError, match="or --decimal ,"):
        fiberbend.fit(path, "neo-hooke")
    found = fiberbend.fit(path, "neo-hooke", decimal=",")
    assert found.parameters["mu"] == pytest.approx(6, rel=1e-3)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ({"weights": "Relative"}, "weights: 'Relative', expected one of 'plain', 'relative'"),
        ({"meant": "nominal"}, "meant: 'nominal', expected one of 'engineering', 'true'"),
        ({"decimal": ";"}, "decimal: ';', expected one of"),
        ({"only": "biaxial"}, "only: 'biaxial', expected one of 'uniaxial'"),
        ({"only": "pure-shear"}, "no test in pure-shear, expected one"),
        ({"gauge": "0 mm"}, '"0 mm", expected a length above zero'),
        ({"area": ("-6 mm", "-3 mm")}, '"-6 mm", expected a length above zero'),
        ({"area": "6 mm"}, "area '6 mm', expected width and thickness"),
    ],
)
def test_words_that_are_not_known_are_refused(words: dict[str, Any], line: str) -> None:
    with pytest.raises(fiberbend.CaseError) as error:
        fiberbend.fit(RUBBER, "neo-hooke", **words)
    assert line in str(error.value)


def test_densities_below_zero_and_a_test_twice_are_refused(tmp_path: Path) -> None:
    with pytest.raises(fiberbend.CaseError, match="given more than once, expected each test once"):
        fiberbend.fit([RUBBER, RUBBER], "neo-hooke")
    again = tmp_path / "again.csv"
    again.write_bytes(file_of(Path(RUBBER)).read_bytes())
    given: list[dict[str, Any]] = [
        {"uniaxial": [RUBBER, str(again)]},
        {"uniaxial": RUBBER, "equibiaxial": str(again)},
    ]
    for words in given:
        with pytest.raises(fiberbend.CaseError, match="the same points as dragon-skin-30"):
            fiberbend.fit(law="neo-hooke", **words)
    again.unlink()
    found = fiberbend.fit(RUBBER, "neo-hooke")
    with pytest.raises(fiberbend.CaseError, match="expected a density zero or above"):
        found.save(tmp_path / "rubber.yaml", density="-1 g/cm^3")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("option", "line"),
    [
        (["--density=-1 g/cm^3"], '--density: "-1 g/cm^3", expected a density zero or above'),
        (["--refits", "5"], "--refits: no effect without --case, expected a case"),
    ],
)
def test_options_of_no_effect_or_sense_are_refused(
    option: list[str],
    line: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(["fit", RUBBER, "--law", "neo-hooke", *option]) == 1
    assert line in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("offset", "told"), [(0.0, False), (0.004, True)])
def test_a_stress_at_rest_is_told(offset: float, told: bool, tmp_path: Path) -> None:
    stretch = np.linspace(1, 1.6, 13)
    stress = 0.06 * (stretch - stretch**-2) + offset
    rows = "".join(f"{a:.6f},{b:.6f}\n" for a, b in zip(stretch, stress, strict=True))
    path = tmp_path / "test.csv"
    path.write_text(f"stretch,nominal stress [MPa]\n{rows}", encoding="utf-8")
    said = str(fiberbend.fit(path, "neo-hooke"))
    assert ("test.csv: 4 kPa at rest, 5.2 % of the greatest stress: the zero" in said) is told


@pytest.mark.parametrize("begin", [0.0, 2.0, 33.0])
def test_slack_and_lengths_in_place_of_displacements_are_told(begin: float, tmp_path: Path) -> None:
    stretch = np.linspace(1, 1.6, 13)
    force = 18 * 0.06 * (stretch - stretch**-2)
    rows = "".join(
        f"{33 * (a - 1) + begin:.6f},{b:.6f}\n" for a, b in zip(stretch, force, strict=True)
    )
    path = tmp_path / "test.csv"
    path.write_text(f"extension [mm],load [N]\n{rows}", encoding="utf-8")
    found = fiberbend.fit(path, "neo-hooke", gauge="33 mm", area=("6 mm", "3 mm"))
    line = f"test.csv: hardly a stress at stretch {1 + begin / 33:.4g}: slack, or lengths in place"
    assert (line in str(found)) is (begin > 0)
