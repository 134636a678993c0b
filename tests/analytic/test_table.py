"""Tables of measured data, as spreadsheets, instruments and scripts write them.

A number that is misread goes into a comparison unseen: what could be read in two ways is refused.
"""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from analytic.table import read_columns, read_table

COLUMNS = ("pressure_kPa", "angle_deg")
POINTS = [[1.5, 2.3], [4.0, 50.25]]


def read(folder: Path, text: str | bytes, **how: str) -> list[list[float]]:
    """Both columns of a file of two."""
    path = folder / "curve.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    table = read_table(path, **how)
    assert len(table.columns) == 2, table.columns
    return table.values([0, 1])


def refusal(folder: Path, text: str | bytes, **how: str) -> str:
    with pytest.raises(ValueError, match=r"curve\.csv") as error:
        read(folder, text, **how)
    return str(error.value)


def test_curve_is_read_from_a_csv(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text("\ufeffangle_deg, trial,pressure_kPa\n90, a, 78.2\n\n180,b,140.7\n", "utf-8")
    assert read_columns(path, COLUMNS) == [[78.2, 90.0], [140.7, 180.0]]


@pytest.mark.parametrize(
    "text",
    [
        "P,theta\n1.5,2.3\n4,50.25\n",
        "P;theta\n1,5;2,3\n4;50,25\n",
        "P;theta\n1.5;2.3\n4;50.25\n",
        "P; theta\r\n1,5; 2,3\r\n4; 50,25\r\n",
        "P\ttheta\n1,5\t2,3\n4\t50,25\n",
        "P\ttheta\n1.5\t2.3\n4\t50.25",
        "P theta\n1,5 2,3\n4 50,25\n",
        "P   theta\n 1.5    2.3\n 4     50.25\n",
        "P|theta\n1.5|2.3\n4|50.25\n",
        # in quotes, with decimal commas between commas
        '"P","theta"\n"1,5","2,3"\n"4","50,25"\n',
        '"P";"theta"\n"1,5";"2,3"\n4;50,25\n',
        '"P" "theta"\n1.5 2.3\n4 50.25\n',
        # a spreadsheet's empty cells, and its line that names the delimiter
        "sep=;\nP;theta\n1,5;2,3\n4;50,25\n",
        "P;theta;;\n1,5;2,3;;\n4;50,25;;\n;;;\n",
        # comments, and names in the comment above the numbers, as numpy.savetxt writes them
        "# trial 3; finger, of May\n\nP;theta\n% warm\n1,5;2,3\n// late\n4;50,25\n",
        "# P,theta\n1.5,2.3\n4,50.25\n",
        "# by hand\n# P theta\n1.50e0 2.30e+00\n4e0 5.025E1\n",
        # units in the names
        "P [kPa], theta [deg]\n1.5, 2.3\n4, 50.25\n",
        "P [kPa];theta [°]\n1,5;2,3\n4;50,25\n",
        "P [kPa]  theta [deg]\n1.5 2.3\n4 50.25\n",
        "P [kPa] theta (deg)\n1.5 2.3\n4 50.25\n",
        "P in kPa   theta in deg\n1.5 2.3\n4 50.25\n",
        "P, in kPa;theta, in deg\n1,5;2,3\n4;50,25\n",
        "P [kPa; gauge],theta\n1.5,2.3\n4,50.25\n",
        "P / kPa;theta / deg\n1,5;2,3\n4;50,25\n",
    ],
)
def test_one_curve_in_many_hands(text: str, tmp_path: Path) -> None:
    assert read(tmp_path, text) == POINTS


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_encodings(encoding: str, tmp_path: Path) -> None:
    text = "Druck [kPa];Winkel [°]\n1,5;2,3\n4;50,25\n"
    assert read(tmp_path, text.encode(encoding)) == POINTS
    assert read_table(tmp_path / "curve.csv").columns == ("Druck [kPa]", "Winkel [°]")


def test_a_minus_as_typesetters_write_it(tmp_path: Path) -> None:
    assert read(tmp_path, "P,theta\n-1.5,−2.3\n1e-1,1e−1\n") == [[-1.5, -2.3], [0.1, 0.1]]


def test_texts_beside_the_numbers(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text("trial;P;note;theta\nA 1, left;1,5;first, warm;2,3\nB;4;;50,25\n")
    assert read_columns(path, ("P", "theta")) == POINTS


@pytest.mark.parametrize(
    ("text", "message"),
    [
        # never 1, 5, 2, 3, and never 15 and 23
        ("P,theta\n1,5;2,3\n", "line 2: 3 cells between commas, expected 2 as there are names"),
        ("P,theta\n1,5,2,3\n", "line 2: 4 cells between commas"),
        ("P,theta,note\n1,5,2,3\n", "beside decimal commas the delimiter must be another"),
        ("P,theta,note,more,yet\n1,5,2,3\n", "line 2: 4 cells between commas, expected 5"),
        ("P;theta\n1,5;2.3\n", "line 2: '1,5' has a comma and '2.3' in line 2 a point"),
        ("P;theta\n1.5;2\n1,234.5;3\n", "line 3: 'P' is '1,234.5', expected a number"),
        ("P;theta\n1,234,567;3\n", "line 2: 'P' is '1,234,567', expected a number"),
        ("P;theta\n101,325;90\n", "line 2: '101,325' is 101.325 or 101325, expected a point"),
        ("P\ttheta\n1,234\t2,345\n", "line 2: '1,234' is 1.234 or 1234"),
        ('P,theta\n"1,234",90\n', "line 2: '1,234' is 1.234 or 1234"),
        ("P;theta\n1 234,5;2\n", "line 2: 'P' is '1 234,5', expected a number"),
        ("P theta\n1,5, 2,3\n", "expected a number"),
        # what is missing
        ("", "no rows, expected a line of names and lines of numbers"),
        ("# only a comment\n", "no rows, expected a line of names"),
        ("P,theta\n", "curve.csv: no rows"),
        ("P,theta\n,\n", "curve.csv: no rows"),
        ("1.5,2.3\n4,50.25\n", "line 1: '1.5,2.3', expected names of columns"),
        ("P\n1\n2\n", "one column 'P', expected two, and one of tab, semicolon, comma"),
        ("P,theta\n1,2\n3\n", "line 3: 1 cell between commas, expected 2"),
        ("P,theta\n1,2\n3,\n", "line 3: 'theta' is empty, expected a number"),
        ("P,theta\n1,2\n3,much\n", "line 3: 'theta' is 'much', expected a number"),
        ("P,theta\ninf,2\n", "line 2: 'P' is 'inf', expected a number"),
        ("P,theta\n1,nan\n", "line 2: 'theta' is 'nan', expected a number"),
        ("P,theta\n1,1e999\n", "line 2: 'theta' is '1e999', expected a number"),
        ("P,theta\n1,٣\n", "line 2: 'theta' is '٣', expected a number"),
        ("sep=x\nP,theta\n1,2\n", "sep=x, expected one of tab"),
        ("\x00\x01", "curve.csv: not a CSV file"),
        (b"\xff\xfe\x00", "curve.csv: not a CSV file"),
    ],
)
def test_what_could_be_misread_is_refused(text: str | bytes, message: str, tmp_path: Path) -> None:
    assert message in refusal(tmp_path, text)


def test_what_a_case_says_decides(tmp_path: Path) -> None:
    assert read(tmp_path, "P;theta\n101,325;90\n", decimal=",") == [[101.325, 90.0]]
    assert "'101,325', expected a number" in refusal(tmp_path, "P;theta\n101,325;90\n", decimal=".")
    assert "'1.5', expected a number" in refusal(tmp_path, "P;theta\n1.5;90\n", decimal=",")
    assert read(tmp_path, "P,theta\n1,2\n", delimiter=",") == [[1.0, 2.0]]
    assert "one column 'P,theta'" in refusal(tmp_path, "P,theta\n1,2\n", delimiter=";")


def test_tables_by_chance_are_read_exactly_or_refused(tmp_path: Path) -> None:
    chance = random.Random(7)
    shapes = ("{:.6g}", "{:.2f}", "{:.3f}", "{:.0f}", "{:.3e}")
    spreads = (400.0, 2e5)
    path, ends = tmp_path / "curve.csv", {"read": 0, "refused": 0}
    for _ in range(2000):
        delimiter = chance.choice(["\t", ";", ",", "; ", ", ", " ", "   ", "|"])
        decimal, shape = chance.choice(".,"), chance.choice(shapes)
        width, quote = chance.choice([2, 2, 3, 4]), chance.choice(["", "", "", '"'])
        texts = [
            [shape.format(chance.uniform(-5, chance.choice(spreads))) for _ in range(width)]
            for _ in range(chance.randint(1, 4))
        ]
        units = chance.choice([("", "", "", ""), (" [kPa]", " [deg]", " [N]", " (s)")])
        names = [f"{name}{unit}" for name, unit in zip("PQFt", units, strict=True)][:width]
        lines = [names, *([f"{quote}{t.replace('.', decimal)}{quote}" for t in r] for r in texts)]
        path.write_text("\n".join(delimiter.join(line) for line in lines), encoding="utf-8")
        try:
            table = read_table(path)
            found = table.values(range(width))
        except ValueError:
            ends["refused"] += 1
            continue
        ends["read"] += 1
        assert len(table.columns) == width
        assert found == [[float(text) for text in row] for row in texts]
    assert ends["refused"] < 0.15 * ends["read"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("pressure,angle_deg\n1,2\n", "no column pressure_kPa, found columns 'pressure', 'angle"),
        ("pressure_kPa;x\n1;2\n", "no column angle_deg, found .* between semicolons"),
        ("pressure_kPa,angle_deg,angle_deg\n1,2,3\n", "no column angle_deg, found"),
    ],
)
def test_columns_by_name(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=message):
        read_columns(path, COLUMNS)
