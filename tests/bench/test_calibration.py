"""The page of calibrated windings, made row by row."""

from __future__ import annotations

from collections.abc import Iterator

from bench.calibration import Part, renewed


def rows(_name: str) -> Iterator[str]:
    """None: they are given here."""
    yield from ()


PART = Part("Some", "| geometry | P |", rows, ("one", "two", "two and more"))
PAGE = (
    "# Page\n\nText.\n\n## Some\n\n| geometry | P |\n|---|---|\n| two | 2 |\n\n## Last\n\n| a |\n"
)


def test_a_row_takes_its_place_and_the_others_stay() -> None:
    page = renewed(PAGE, PART, "two and more", ["| two and more | 3 |", "| two and more | 4 |"])
    page = renewed(page, PART, "one", ["| one | 1 |"])
    page = renewed(page, PART, "two and more", ["| two and more | 5 |"])
    assert page == PAGE.replace("| two | 2 |", "| one | 1 |\n| two | 2 |\n| two and more | 5 |")


def test_a_table_that_is_not_there_comes_last() -> None:
    page = renewed("# Page\n", PART, "two", ["| two | 2 |"])
    assert page == "# Page\n\n## Some\n\n| geometry | P |\n|---|---|\n| two | 2 |\n\n"
