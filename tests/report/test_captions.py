"""Below a picture stands what it shows, not the name of its file."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from fiberbend.report.captions import caption
from fiberbend.report.run_page import report
from tests.report.folders import bent_folder, case, rows, run_of


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("pressure_angle.png", "Bending angle against pressure."),
        ("bent_090deg.png", "Strain at 46.3 kPa, 90°."),
        ("bent_other.png", "Strain: other."),
        ("of_another_kind.png", "of another kind"),
    ],
)
def test_a_picture_is_named_by_what_it_shows(name: str, expected: str) -> None:
    assert caption(name, {"090deg": "46.3 kPa, 90°"}) == expected


def test_no_caption_of_a_page_is_the_name_of_a_file(tmp_path: Path) -> None:
    folder = bent_folder(tmp_path / "run", case(), run_of())
    found = re.findall("<figcaption>(.*?)</figcaption>", report(folder, case(), rows(), run_of()))
    assert found
    assert all(text[0].isupper() and text.endswith(".") for text in found)


def test_a_page_without_a_folder_names_none(tmp_path: Path) -> None:
    folder = bent_folder(tmp_path / "tmp4711", case(), run_of())
    page = report(folder, case(title=""), rows(), run_of(), loose=True)
    assert "tmp4711" not in page
    assert "beside this page" not in page
    assert "tmp4711" in report(folder, case(title=""), rows(), run_of())
