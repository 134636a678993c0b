"""Tests of rubber from files: delimiters, units, measures, cycles, and what is refused."""

from __future__ import annotations

import fnmatch
import itertools
import re
from pathlib import Path

import numpy as np
import pytest

from fiberbend.schema.problems import CaseError
from fiberbend.tensile.cycles import loading, turns
from fiberbend.tensile.reading import Read, Wanted, limit, read_test
from fiberbend.tensile.shipped import file_of, folder, names

STRETCH = np.array([1.0, 1.1, 1.2, 1.4, 1.7])
STRESS = np.array([0.0, 0.021, 0.039, 0.07, 0.11])
"""MPa, per area at rest."""


def lines(head: str, *columns: np.ndarray, mark: str = ",", comma: bool = False) -> str:
    rows = [mark.join(f"{value:.12g}" for value in row) for row in zip(*columns, strict=True)]
    text = "\n".join(rows)
    return f"{head}\n{text.replace('.', ',') if comma else text}\n"


def read(tmp_path: Path, text: str, wanted: Wanted | None = None, mode: str = "uniaxial") -> Read:
    path = tmp_path / "test.csv"
    path.write_text(text, encoding="utf-8")
    return read_test(path, mode, wanted)  # type: ignore[arg-type]


FILES = {
    "stretch": lines("stretch,engineering stress [MPa]", STRETCH, STRESS),
    "percent": lines(
        "Nominal strain (%);Nominal stress (kPa)", 100 * (STRETCH - 1), 1e3 * STRESS, mark=";"
    ),
    "true": lines(
        "true strain\tCauchy stress [Pa]", np.log(STRETCH), 1e6 * STRESS * STRETCH, mark="\t"
    ),
    "mixed": lines("log_strain,PK1_psi", np.log(STRETCH), STRESS / 0.006894757293168361),
    "commas": lines(
        "engineering strain [1];eng. stress [N/mm^2]", STRETCH - 1, STRESS, mark=";", comma=True
    ),
    "units below": lines(
        "Machine: X 12\nDate;28.11.2026\nTime;Eng Strain;Eng Stress\n(s);(%);(MPa)",
        np.arange(5.0),
        100 * (STRETCH - 1),
        STRESS,
        mark=";",
    ),
    "units below without brackets": lines(
        "Time,Eng Strain,Eng Stress\ns,-,N/mm2", np.arange(5.0), STRETCH - 1, STRESS
    ),
    # a percent sign begins comments too
    "percent below": lines(
        "Eng Strain;Eng Stress\n%;kPa", 100 * (STRETCH - 1), 1e3 * STRESS, mark=";"
    ),
    "of several": lines(
        "true stress [MPa],true strain,engineering strain,engineering stress [MPa]",
        STRESS * STRETCH,
        np.log(STRETCH),
        STRETCH - 1,
        STRESS,
    ),
    "elongation": lines("Elongation (%),nominal stress (bar)", 100 * (STRETCH - 1), 10 * STRESS),
    "extension ratio": lines("extension ratio,nominal stress [N/mm2]", STRETCH, STRESS),
}


@pytest.mark.parametrize("name", FILES)
def test_files_of_all_kinds_say_the_same(name: str, tmp_path: Path) -> None:
    found = read(tmp_path, FILES[name]).measurement
    assert found.stretch == pytest.approx(STRETCH, rel=1e-9)
    assert found.stress == pytest.approx(STRESS, rel=1e-9)


def test_columns_by_number_and_by_name(tmp_path: Path) -> None:
    text = lines("", 1e3 * STRESS, STRETCH).lstrip()
    wanted = Wanted(stretch="2", stress="1 [kPa]", meant="engineering")
    assert read(tmp_path, text, wanted).measurement.stress == pytest.approx(STRESS)
    text = lines("Dehnung,Spannung", 100 * (STRETCH - 1), 1e3 * STRESS)
    wanted = Wanted(strain="Dehnung [%]", stress="spannung [kPa]", meant="engineering")
    found = read(tmp_path, text, wanted)
    assert found.measurement.stretch == pytest.approx(STRETCH)
    assert found.measurement.stress == pytest.approx(STRESS)
    assert "from 'Dehnung' and 'Spannung'" in found.said


def test_a_column_is_what_its_unit_says(tmp_path: Path) -> None:
    text = lines("elongation,nominal stress [MPa]", 100 * (STRETCH - 1), STRESS)
    found = read(tmp_path, text, Wanted(strain="elongation [%]"))
    assert found.measurement.stretch == pytest.approx(STRETCH, rel=1e-9)


def test_a_strain_without_a_unit_is_told(tmp_path: Path) -> None:
    text = lines("engineering strain,nominal stress [MPa]", STRETCH - 1, STRESS)
    assert "from 'engineering strain' (1 is 100 %) and" in read(tmp_path, text).said
    assert "100 %" not in read(tmp_path, FILES["percent"]).said


def test_compression_is_below_zero(tmp_path: Path) -> None:
    text = lines("compressive eng. strain,eng stress [MPa]", 1 / STRETCH - 1, -STRESS)
    assert read(tmp_path, text).measurement.stretch == pytest.approx(1 / STRETCH, rel=1e-9)


def test_forces_and_displacements(tmp_path: Path) -> None:
    text = lines("Time (s),Extension (mm),Load (mN)", STRETCH, 33 * (STRETCH - 1), 18e3 * STRESS)
    found = read(tmp_path, text, Wanted(gauge=33.0, area=18.0)).measurement
    assert found.stretch == pytest.approx(STRETCH)
    assert found.stress == pytest.approx(STRESS)


PLAIN = lines("strain,stress [MPa]", STRETCH - 1, STRESS)
REFUSED = {
    "neither": (
        PLAIN,
        Wanted(),
        "'strain' is an engineering or a true strain",
    ),
    "no unit": (
        lines("stretch,engineering stress", STRETCH, STRESS),
        Wanted(),
        "has no unit, expected one such as [MPa]",
    ),
    "a unit of something else": (
        lines("stretch,engineering stress [mm]", STRETCH, STRESS),
        Wanted(),
        "expected a unit of a modulus",
    ),
    "percent without its sign": (
        lines("engineering strain,engineering stress [MPa]", 100 * STRETCH, STRESS),
        Wanted(),
        "has no unit, expected [%] or [1]",
    ),
    "signs in cells": (
        "engineering strain,engineering stress [MPa]\n10 %,0.021\n20 %,0.039\n",
        Wanted(),
        "no lines of numbers, the last line is '20 %,0.039'",
    ),
    "two stresses": (
        lines("stretch,eng stress 1 [MPa],eng stress 2 [MPa]", STRETCH, STRESS, STRESS),
        Wanted(),
        "expected --stress with one of them",
    ),
    "no such column": (PLAIN, Wanted(stress="kraft", meant="true"), "no column 'kraft', found"),
    "another strain": (
        lines("Green-Lagrange strain,eng stress [MPa]", STRETCH, STRESS),
        Wanted(meant="engineering"),
        "no column of stretch or strain, found 'Green-Lagrange strain'",
    ),
    "another stress": (
        lines("stretch,second Piola-Kirchhoff stress [MPa]", STRETCH, STRESS),
        Wanted(meant="engineering"),
        "no column of stress",
    ),
    "a strain": (
        PLAIN,
        Wanted(stretch="strain"),
        "is a strain, found under --stretch",
    ),
    "a force": (
        lines("stretch,force [N]", STRETCH, STRESS),
        Wanted(),
        "'force [N]' is a force, expected --width and --thickness at rest",
    ),
    "columns that do not agree": (
        lines(
            "engineering strain,true strain,eng stress [MPa]",
            STRETCH - 1,
            np.log(1 + 2 * (STRETCH - 1)),
            STRESS,
        ),
        Wanted(),
        "'engineering strain' and 'true strain' differ by 1e+02 % of the greatest, expected",
    ),
    "no stretch": (
        lines("engineering strain,eng stress [MPa]", STRETCH - 2.5, STRESS),
        Wanted(),
        "expected 0.05 to 20",
    ),
    "nothing in the range": (
        FILES["stretch"],
        Wanted(least=3.0),
        "no points in the range asked for",
    ),
    "no number": (
        "stretch,engineering stress [MPa]\n1,0\n1.1,nan\n",
        Wanted(),
        "line 3: 'engineering stress [MPa]' is 'nan', expected a number",
    ),
    "no file of columns": ("hello\n", Wanted(), "one column 'hello'"),
    "compression above zero": (
        lines("engineering compressive strain,eng stress [MPa]", STRETCH - 1, STRESS),
        Wanted(),
        "'engineering compressive strain' counts compression above zero, expected strains",
    ),
    "stresses of compression above zero": (
        lines("engineering strain,compressive eng stress [MPa]", 1 / STRETCH - 1, STRESS),
        Wanted(),
        "'compressive eng stress [MPa]' counts compression above zero",
    ),
    "stresses against strains": (
        lines("engineering strain,eng stress [MPa]", 1 / STRETCH - 1, STRESS),
        Wanted(),
        "'eng stress [MPa]' acts against 'engineering strain', expected both above zero in",
    ),
    "a name of two columns": (
        lines("eng strain,eng stress [MPa],eng strain", STRETCH - 1, STRESS, STRETCH - 1),
        Wanted(strain="eng strain"),
        "'eng strain' is more than one column, expected its number, 1 or 3",
    ),
    "another unit than the file's": (
        FILES["stretch"],
        Wanted(stress="engineering stress [kPa]"),
        "'engineering stress [MPa]' has another unit than 'kPa', expected none beside it",
    ),
    "commas that may be thousands": (
        "stretch;engineering stress (MPa)\n1,100;1,200\n1,200;2,300\n",
        Wanted(),
        "line 2: '1,100' is 1.100 or 1100, expected a point before decimals, or --decimal ,",
    ),
    "true and engineering": (
        lines("true engineering strain,eng stress [MPa]", STRETCH - 1, STRESS),
        Wanted(),
        "'true engineering strain' is an engineering or a true strain, expected --as",
    ),
    "a third cycle": (FILES["stretch"], Wanted(cycle=3), "one loading and no cycles"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_clear_is_refused(name: str, tmp_path: Path) -> None:
    text, wanted, message = REFUSED[name]
    with pytest.raises(CaseError) as error:
        read(tmp_path, text, wanted)
    assert message in str(error.value)
    assert len(str(error.value).splitlines()) == 1
    assert str(error.value).count("test.csv") == 1


def test_a_name_that_is_nearly_that_of_a_test() -> None:
    for name in ("dragon-skin-10", "dragon-skin-10-medium.csv"):
        with pytest.raises(CaseError, match=r"a file; did you mean dragon-skin-10-medium\?"):
            read_test(file_of(Path(name)))


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="No such file"):
        read_test(tmp_path / "none.csv")


def cycles(*peaks: float) -> np.ndarray:
    """Stretches to peaks and back, twenty points a branch, with noise."""
    ends = [end for peak in peaks for end in (1.0, peak)] + [1.0]
    parts = [np.linspace(a, b, 20, endpoint=False) for a, b in itertools.pairwise(ends)]
    noise = 1e-4 * np.random.default_rng(1).standard_normal(20 * len(parts))
    return np.concatenate(parts) + noise


def test_loadings_of_cycles() -> None:
    stretch = cycles(1.5, 1.5, 1.8)
    for number, (first, last, peak) in enumerate([(0, 20, 1.5), (40, 60, 1.5), (80, 100, 1.8)], 1):
        rows = loading(stretch, number)
        assert abs(rows.start - first) <= 1
        assert abs(rows.stop - 1 - last) <= 1
        assert stretch[rows].max() == pytest.approx(peak, abs=1e-3)
    with pytest.raises(ValueError, match="3 loadings, expected --cycle up to that, found 4"):
        loading(stretch, 4)


def test_a_single_loading_is_taken_whole() -> None:
    for ends in ((1.0, 2.0), (2.0, 1.0), (0.5, 2.0), (1.0, 0.4)):
        stretch = np.linspace(*ends, 50) + 1e-4 * np.random.default_rng(2).standard_normal(50)
        assert loading(stretch, 1) == slice(0, 50)
    assert turns(np.array([1.0, 1.5, 1.0])) == [0, 1, 2]


def test_rows_in_no_order_have_no_cycles() -> None:
    mixed = np.random.default_rng(3).permutation(np.linspace(1, 2, 60))
    with pytest.raises(ValueError, match="in no order of time"):
        loading(mixed, 1)


def test_ranges_are_of_the_greatest_stretch(tmp_path: Path) -> None:
    pressed = np.array([0.4, 0.5, 0.7, 1.0, 1.3, 1.6])
    text = lines("stretch,nominal stress [MPa]", pressed, pressed - 1)
    found = read(tmp_path, text, Wanted(most=1.5)).measurement
    # pressed to 0.4 a bar is 1.58 wide
    assert found.stretch == pytest.approx([0.5, 0.7, 1.0, 1.3])
    assert found.greatest == pytest.approx(0.5**-0.5)
    found = read(tmp_path, text, Wanted(most=1.5, least=1.0)).measurement
    assert found.stretch == pytest.approx([1.0, 1.3])


def test_limits() -> None:
    assert limit("stretch 1.5") == 1.5
    assert limit("strain 50 %") == 1.5
    assert limit(" strain 0.5") == 1.5
    for text in ("1.5", "stretch", "stretch -1", "stress 2", "strain 5 kPa", "stretch 1.2.3"):
        with pytest.raises(ValueError, match="expected"):
            limit(text)


@pytest.mark.parametrize("name", names())
def test_what_comes_with_the_program_is_read(name: str) -> None:
    assert file_of(Path(name)).parent == folder()
    found = read_test(file_of(Path(name))).measurement
    assert len(found.stretch) > 10
    sources = (folder() / "SOURCES.md").read_text(encoding="utf-8")
    assert any(fnmatch.fnmatch(f"{name}.csv", p) for p in re.findall(r"[\w*-]+\.csv", sources))
    assert file_of(Path(f"{name}.csv")) == Path(f"{name}.csv")
